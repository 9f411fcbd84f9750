//! The graph of imports, and the cycles in it.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::iter::successors;

/// Which module imports which, each with the place of the first import.
#[derive(Default)]
pub(crate) struct Graph {
    edges: BTreeMap<String, BTreeMap<String, String>>,
}

impl Graph {
    /// Enters that `from` imports `to`, at `place`; the first place counts.
    pub(crate) fn enter(&mut self, from: &str, to: &str, place: String) {
        self.edges.entry(from.to_owned()).or_default().entry(to.to_owned()).or_insert(place);
    }

    /// A shortest way from one module to another, both ends included.
    fn way(&self, from: &str, to: &str) -> Option<Vec<String>> {
        let mut before: BTreeMap<&str, &str> = BTreeMap::new();
        let mut open = VecDeque::from([from]);
        while let Some(at) = open.pop_front() {
            if at == to {
                let mut way: Vec<String> =
                    successors(Some(at), |&at| before.get(at).copied()).map(str::to_owned).collect();
                way.reverse();
                return Some(way);
            }
            for next in self.edges.get(at).into_iter().flat_map(BTreeMap::keys) {
                if next != from && !before.contains_key(next.as_str()) {
                    before.insert(next.as_str(), at);
                    open.push_back(next);
                }
            }
        }
        None
    }
}

/// For each import that lies on a cycle a shortest such cycle, less those that go through all modules of a shorter one: `a → b (a.rs:3) → a (b.rs:7)`.
pub(crate) fn cycles(graph: &Graph) -> Vec<String> {
    let mut found = BTreeSet::new();
    for (from, imports) in &graph.edges {
        for to in imports.keys() {
            if let Some(mut cycle) = graph.way(to, from) {
                let least = (0..cycle.len()).min_by_key(|&i| &cycle[i]).unwrap_or(0);
                cycle.rotate_left(least);
                found.insert(cycle);
            }
        }
    }
    let mut found: Vec<Vec<String>> = found.into_iter().collect();
    found.sort_by_key(Vec::len);
    let mut least: Vec<Vec<String>> = Vec::new();
    for cycle in found {
        if !least.iter().any(|shorter| shorter.iter().all(|module| cycle.contains(module))) {
            least.push(cycle);
        }
    }
    least.iter().map(|cycle| chain(graph, cycle)).collect()
}

fn chain(graph: &Graph, cycle: &[String]) -> String {
    let mut text = cycle[0].clone();
    for (at, next) in cycle.iter().zip(cycle.iter().cycle().skip(1)) {
        text += &format!(" → {next} ({})", graph.edges[at][next]);
    }
    text
}
