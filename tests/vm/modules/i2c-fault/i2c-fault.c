// SPDX-License-Identifier: MIT OR GPL-2.0
/*
 * i2c-fault: an I2C adapter with chips of 256 word registers behind it, whose
 * wires can be made to fail while a program uses them.
 *
 * Unlike i2c-stub it is an adapter of messages, so the kernel's own SMBus code
 * computes and checks real PEC, and combined transfers (I2C_RDWR) work. And it
 * can be removed under a program that holds /dev/i2c-N open, as a USB adapter
 * can. README.md in tests/vm tells what each parameter does.
 */
#include <linux/delay.h>
#include <linux/i2c.h>
#include <linux/jiffies.h>
#include <linux/module.h>
#include <linux/random.h>

#define MAX_CHIPS 16
#define EEPROM_FIRST 0x20
#define EEPROM_LAST 0x3f
#define EEPROM_ADDRESS 0x2e
/* An MLX90614 is busy for some ms with a cell; a driver should wait 10 ms. */
#define EEPROM_WRITE_TIME msecs_to_jiffies(5)

struct chip {
	u16 addr;
	u8 pointer; /* the register that a read without a command reads */
	u16 word[256];
	unsigned long eeprom_busy_until;
};

static struct chip chips[MAX_CHIPS];
static unsigned long calls; /* counts every transfer, to choose each N-th */

/* At load. */
static unsigned short chip_addr[MAX_CHIPS];
static int chip_count;
module_param_array(chip_addr, ushort, &chip_count, 0444);
MODULE_PARM_DESC(chip_addr, "addresses that have a chip, e.g. 0x5a,0x5b");
static int nr = -1;
module_param(nr, int, 0444);
MODULE_PARM_DESC(nr, "bus number, -1: the next free one");

/* At run time; the lists are of addresses, 0 means none. */
static unsigned short bad_pec[MAX_CHIPS], nak[MAX_CHIPS], garbage[MAX_CHIPS];
static int bad_pec_count, nak_count, garbage_count;
module_param_array(bad_pec, ushort, &bad_pec_count, 0644);
MODULE_PARM_DESC(bad_pec, "addresses whose reads carry a wrong PEC");
module_param_array(nak, ushort, &nak_count, 0644);
MODULE_PARM_DESC(nak, "addresses that do not answer (ENXIO)");
module_param_array(garbage, ushort, &garbage_count, 0644);
MODULE_PARM_DESC(garbage, "addresses whose reads give random words with a right PEC");
static uint every = 1;
module_param(every, uint, 0644);
MODULE_PARM_DESC(every, "the three faults above strike at each N-th transfer only");
static bool held;
module_param(held, bool, 0644);
MODULE_PARM_DESC(held, "the bus is held: every transfer gives ETIMEDOUT");
static uint delay_us;
module_param(delay_us, uint, 0644);
MODULE_PARM_DESC(delay_us, "how long every transfer takes");
static bool eeprom;
module_param(eeprom, bool, 0644);
MODULE_PARM_DESC(eeprom, "0x20 to 0x3f behave as the MLX90614's EEPROM");
static ulong transfers;
module_param(transfers, ulong, 0444);
MODULE_PARM_DESC(transfers, "transfers that reached a chip and succeeded");

static bool dying;

static bool listed(u16 addr, const unsigned short *list, int count)
{
	while (count-- > 0)
		if (list[count] && list[count] == addr)
			return true;
	return false;
}

/* Address 0 is the MLX90614's "whoever is there": the first chip answers. */
static struct chip *chip_at(u16 addr)
{
	int i;

	for (i = 0; i < chip_count; i++)
		if (chips[i].addr == addr || !addr)
			return &chips[i];
	return NULL;
}

static u8 crc8(u8 crc, u8 byte)
{
	int bit;

	crc ^= byte;
	for (bit = 0; bit < 8; bit++)
		crc = crc & 0x80 ? crc << 1 ^ 0x07 : crc << 1;
	return crc;
}

/* The PEC so far of a message that begins with addr and direction. */
static u8 crc8_message(u8 crc, const struct i2c_msg *msg, int len)
{
	int i;

	crc = crc8(crc, i2c_8bit_addr_from_msg(msg));
	for (i = 0; i < len; i++)
		crc = crc8(crc, msg->buf[i]);
	return crc;
}

static int store_word(struct chip *chip, u8 reg, u16 value, bool with_pec)
{
	if (eeprom && reg >= EEPROM_FIRST && reg <= EEPROM_LAST) {
		if (!with_pec)
			return -ENXIO;
		/* Lost, without a word, as on the chip: too soon, or not erased. */
		if (time_before(jiffies, chip->eeprom_busy_until))
			return 0;
		if (value && chip->word[reg])
			return 0;
		chip->eeprom_busy_until = jiffies + EEPROM_WRITE_TIME;
	}
	chip->word[reg] = value;
	return 0;
}

/*
 * Lengths tell what is meant: [], [command], [command low high] and the last
 * with a PEC. A byte write ([command x]) is taken and has no effect; the
 * MLX90614's sleep command with its PEC is one.
 */
static int chip_write(struct chip *chip, const struct i2c_msg *msg)
{
	if (!msg->len)
		return 0;
	chip->pointer = msg->buf[0];
	if (msg->len <= 2)
		return 0;
	if (msg->len > 4)
		return -EOPNOTSUPP;
	if (msg->len == 4 && crc8_message(0, msg, 3) != msg->buf[3])
		return -ENXIO;
	return store_word(chip, msg->buf[0], msg->buf[1] | msg->buf[2] << 8, msg->len == 4);
}

/* Low byte, high byte, PEC, and then the idle bus. */
static int chip_read(struct chip *chip, struct i2c_msg *msg, u8 crc, bool random, bool spoil)
{
	u16 word = random ? get_random_u16() : chip->word[chip->pointer];
	u8 reply[3] = { word & 0xff, word >> 8 };
	int i;

	if (msg->flags & I2C_M_RECV_LEN)
		return -EOPNOTSUPP;
	crc = crc8(crc, i2c_8bit_addr_from_msg(msg));
	reply[2] = crc8(crc8(crc, reply[0]), reply[1]) ^ (spoil ? 0x55 : 0);
	for (i = 0; i < msg->len; i++)
		msg->buf[i] = i < sizeof(reply) ? reply[i] : 0xff;
	return 0;
}

static int fault_xfer(struct i2c_adapter *adapter, struct i2c_msg *msgs, int num)
{
	bool struck = every <= 1 || ++calls % every == 0;
	u8 crc = 0;
	int i, err;

	if (READ_ONCE(dying))
		return -ENODEV;
	if (delay_us)
		fsleep(delay_us);
	if (READ_ONCE(dying))
		return -ENODEV;
	if (held)
		return -ETIMEDOUT;

	for (i = 0; i < num; i++) {
		u16 addr = msgs[i].addr;
		struct chip *chip = chip_at(addr);

		if (!chip || (struck && listed(addr, nak, nak_count)))
			return -ENXIO;
		if (msgs[i].flags & I2C_M_RD) {
			err = chip_read(chip, &msgs[i], crc,
					struck && listed(addr, garbage, garbage_count),
					struck && listed(addr, bad_pec, bad_pec_count));
		} else {
			err = chip_write(chip, &msgs[i]);
			crc = crc8_message(0, &msgs[i], msgs[i].len);
		}
		if (err)
			return err;
	}
	transfers++;
	return num;
}

/* SMBUS_EMUL holds I2C_FUNC_SMBUS_PEC. */
static u32 fault_functionality(struct i2c_adapter *adapter)
{
	return I2C_FUNC_I2C | I2C_FUNC_SMBUS_EMUL;
}

static const struct i2c_algorithm fault_algorithm = {
	.master_xfer = fault_xfer,
	.functionality = fault_functionality,
};

/* No owner: an open /dev/i2c-N must not keep the module from going. */
static struct i2c_adapter adapter = {
	.name = "i2c-fault",
	.algo = &fault_algorithm,
};

/* Power off and on: a chip comes back at the address its EEPROM tells. */
static int power_cycle(const char *value, const struct kernel_param *param)
{
	int i;

	if (!adapter.lock_ops) /* given at load: there is no bus yet */
		return -EINVAL;
	i2c_lock_bus(&adapter, I2C_LOCK_ROOT_ADAPTER);
	for (i = 0; i < chip_count; i++)
		if (chips[i].word[EEPROM_ADDRESS] & 0x7f)
			chips[i].addr = chips[i].word[EEPROM_ADDRESS] & 0x7f;
	i2c_unlock_bus(&adapter, I2C_LOCK_ROOT_ADAPTER);
	return 0;
}
static const struct kernel_param_ops power_cycle_ops = { .set = power_cycle };
module_param_cb(power_cycle, &power_cycle_ops, NULL, 0200);
MODULE_PARM_DESC(power_cycle, "write 1: each chip takes the address in its cell 0x2e");

static int __init fault_init(void)
{
	int i;

	if (!chip_count)
		pr_warn("i2c-fault: no chip_addr given, the bus is empty\n");
	for (i = 0; i < chip_count; i++) {
		chips[i].addr = chip_addr[i];
		chips[i].word[EEPROM_ADDRESS] = 0xbe00 | chip_addr[i];
	}
	adapter.nr = nr;
	return nr < 0 ? i2c_add_adapter(&adapter) : i2c_add_numbered_adapter(&adapter);
}
module_init(fault_init);

/*
 * The node /dev/i2c-N and any driver bound here go at once; transfers of whoever
 * still has the node open fail, and this waits until the last of them closes it.
 */
static void __exit fault_exit(void)
{
	WRITE_ONCE(dying, true);
	i2c_del_adapter(&adapter);
}
module_exit(fault_exit);

MODULE_DESCRIPTION("I2C adapter whose faults are made to order");
MODULE_LICENSE("Dual MIT/GPL");
