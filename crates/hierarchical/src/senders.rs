//! What one element receives its light from: its own links and those of all nodes that it is a part
//! of.

use crate::{Link, Tree};

/// A link that brings light to an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sender {
    /// The node that sends.
    pub node: u32,
    /// The node that receives: the element, or one that it is a part of.
    pub receiver: u32,
    /// Levels from the element up to that node.
    pub level: usize,
    /// A_a F_ab of the link, m².
    pub exchange: f64,
}

/// The senders of a node, those of its own links first, then level by level of what it is a part
/// of.
#[must_use]
pub fn senders(tree: &Tree, links: &[Link], element: u32) -> Vec<Sender> {
    let up = std::iter::successors(Some(element), |&node| tree.nodes()[node as usize].parent());
    let mut found = Vec::new();
    for (level, receiver) in up.enumerate() {
        let own = links.iter().filter_map(|link| match receiver {
            a if a == link.a => Some((link.b, link)),
            b if b == link.b => Some((link.a, link)),
            _ => None,
        });
        let sender = |(node, link): (u32, &Link)| Sender { node, receiver, level, exchange: link.exchange() };
        found.extend(own.map(sender));
    }
    found
}
