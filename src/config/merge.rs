//! A configuration and its drop-ins made one.

use super::endpoint;
use super::raw::{Entry, Node, Table, Value};
use std::collections::BTreeMap;

/// Lays `over` upon `base`: its values win, tables are merged key by key, and the tables of
/// `[[sensor]]` (by `name`) and `[[mavlink.endpoint]]` (by `address`) one by one.
pub fn merge(base: &mut Table, over: Table) {
    merge_at(base, over, "");
}

fn merge_at(base: &mut Table, over: Table, path: &str) {
    for (name, entry) in over {
        let Some(old) = base.get_mut(&name) else {
            base.insert(name, entry);
            continue;
        };
        let path = format!("{path}.{name}");
        let Entry { key, node } = entry;
        match (&mut old.node.value, node.value) {
            (Value::Table(old), Value::Table(new)) => merge_at(old, new, &path),
            (Value::Array(old), Value::Array(new)) if path == ".sensor" => merge_list(old, new, "name", &path),
            (Value::Array(old), Value::Array(new)) if path == ".mavlink.endpoint" => {
                merge_list(old, new, "address", &path)
            }
            (_, value) => *old = Entry { key, node: Node { place: node.place, value } },
        }
    }
}

/// Merges the tables of `new` into those of `old` that have the same `id`, once each: a second one
/// in the same file is a mistake of its own and stays visible as such.
fn merge_list(old: &mut Vec<Node>, new: Vec<Node>, id: &str, path: &str) {
    let mut twins = BTreeMap::new();
    for (i, node) in old.iter().enumerate() {
        if let Some(name) = name(node, id) {
            twins.entry(name).or_insert(i);
        }
    }
    for node in new {
        let twin = name(&node, id).and_then(|name| twins.remove(&name)).and_then(|i| old.get_mut(i));
        match (twin.map(|t| &mut t.value), node.value) {
            (Some(Value::Table(base)), Value::Table(table)) => merge_at(base, table, path),
            (_, value) => old.push(Node { place: node.place, value }),
        }
    }
}

fn name(node: &Node, id: &str) -> Option<String> {
    let Value::Table(table) = &node.value else { return None };
    match &table.get(id)?.node.value {
        // However an address is spelled, it is one: settings that were read are written in a spelling of their own.
        Value::String(s) if id == "address" => Some(endpoint::parse(s).map_or_else(|_| s.clone(), |a| a.to_string())),
        Value::String(s) => Some(s.clone()),
        _ => None,
    }
}
