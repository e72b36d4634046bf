"""One line a check, and the sum at the end."""

import sys
import traceback

passed = failed = 0


def check(what, got, wanted=True):
    global passed, failed
    if got == wanted:
        passed += 1
        print(f"ok   {what}", flush=True)
    else:
        failed += 1
        print(f"FAIL {what}: got {got!r}, wanted {wanted!r}", flush=True)


def section(function, *arguments):
    """Run a group of checks; one that breaks off counts as a failure."""
    try:
        function(*arguments)
    except Exception:
        traceback.print_exc()
        check(f"{function.__name__} came to its end", False)


def end():
    print(f"{passed} passed, {failed} failed", flush=True)
    sys.exit(failed != 0)
