//! Places the nodes of a graph in layers: the order in each layer has few crossings, and dependencies are near vertical.

use super::graph::Graph;
use crate::Result;
use std::collections::BTreeMap;

/// Height of a box \[px\].
pub(super) const BOX_HEIGHT: f64 = 28.0;
/// Distance of two layers' upper edges \[px\].
const LAYER: f64 = 66.0;
/// Least distance between neighbours of a layer \[px\].
const GAP: f64 = 16.0;
/// Width of a letter, at least that of the figure's font \[px\].
const LETTER: f64 = 8.0;
/// Passes over the layers, downwards and upwards in turn.
const PASSES: usize = 40;

/// A placed graph \[px\], y downwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Boxes by name.
    pub boxes: BTreeMap<String, Area>,
    /// Polylines from the lower edge of a box to the upper edge of another; vertical where they pass a layer.
    pub edges: Vec<Vec<(f64, f64)>>,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// A box \[px\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
}

/// A place in a layer: a node's box, or the passage of a dependency between layers further apart.
struct Slot {
    node: Option<String>,
    width: f64,
    layer: usize,
    x: f64,
    above: Vec<usize>,
    below: Vec<usize>,
}

/// Places `graph`, of whose dependencies those drawn that do not follow from others.
pub fn layout(graph: &Graph) -> Result<Layout> {
    let (mut slots, chains) = slots(graph)?;
    let mut order = ordered(&slots);
    place(&mut slots, &mut order);
    let top = order.len() - 1;
    let left = slots.iter().map(|slot| slot.x - slot.width / 2.0).fold(f64::INFINITY, f64::min);
    let right = slots.iter().map(|slot| slot.x + slot.width / 2.0).fold(f64::NEG_INFINITY, f64::max);
    let upper = |slot: &Slot| (top - slot.layer) as f64 * LAYER;
    let boxes = slots
        .iter()
        .filter_map(|slot| {
            let area =
                Area { x: (slot.x - slot.width / 2.0 - left).round(), y: upper(slot), width: slot.width };
            slot.node.clone().map(|name| (name, area))
        })
        .collect();
    let edges = chains
        .iter()
        .map(|chain| {
            let ends = |&slot: &usize| {
                let (x, y) = ((slots[slot].x - left).round(), upper(&slots[slot]));
                [(x, y), (x, y + BOX_HEIGHT)]
            };
            let points: Vec<(f64, f64)> = chain.iter().flat_map(ends).collect();
            points[1..points.len() - 1].to_vec()
        })
        .collect();
    Ok(Layout { boxes, edges, width: (right - left).round(), height: top as f64 * LAYER + BOX_HEIGHT })
}

/// A slot for each node and for each layer that a dependency passes, and the slots of each dependency, from the top.
fn slots(graph: &Graph) -> Result<(Vec<Slot>, Vec<Vec<usize>>)> {
    let layers = graph.layers()?;
    let mut slots: Vec<Slot> = layers
        .iter()
        .map(|(name, &layer)| {
            let width = name.len() as f64 * LETTER + 20.0;
            Slot { node: Some((*name).to_owned()), width, layer, x: 0.0, above: vec![], below: vec![] }
        })
        .collect();
    let index: BTreeMap<&str, usize> = layers.keys().enumerate().map(|(at, name)| (*name, at)).collect();
    let mut chains = Vec::new();
    for (from, to) in graph.reduced() {
        let mut chain = vec![index[from]];
        for layer in (layers[to] + 1..layers[from]).rev() {
            chain.push(slots.len());
            slots.push(Slot { node: None, width: 6.0, layer, x: 0.0, above: vec![], below: vec![] });
        }
        chain.push(index[to]);
        for pair in chain.windows(2) {
            slots[pair[0]].below.push(pair[1]);
            slots[pair[1]].above.push(pair[0]);
        }
        chains.push(chain);
    }
    Ok((slots, chains))
}

/// The slots of each layer from left to right, lowest layer first: each pass sorts by the mean place of the
/// neighbours (barycentre heuristic of Sugiyama et al. 1981), and the order with the fewest crossings is taken.
fn ordered(slots: &[Slot]) -> Vec<Vec<usize>> {
    let layers = slots.iter().map(|slot| slot.layer).max().map_or(1, |top| top + 1);
    let mut order: Vec<Vec<usize>> =
        (0..layers).map(|layer| (0..slots.len()).filter(|&at| slots[at].layer == layer).collect()).collect();
    let mut best = order.clone();
    for pass in 0..PASSES {
        let downwards = pass % 2 == 0;
        for step in 1..layers {
            let layer = if downwards { layers - 1 - step } else { step };
            let places = places(&order, slots.len());
            let key = |&at: &usize| {
                let neighbours = if downwards { &slots[at].above } else { &slots[at].below };
                mean(neighbours.iter().map(|&n| places[n] as f64)).unwrap_or(places[at] as f64)
            };
            order[layer].sort_by(|a, b| key(a).total_cmp(&key(b)));
        }
        swap_neighbours(slots, &mut order);
        if crossings(slots, &order) < crossings(slots, &best) {
            best.clone_from(&order);
        }
    }
    best
}

/// Swaps neighbours of a layer while that removes crossings.
fn swap_neighbours(slots: &[Slot], order: &mut [Vec<usize>]) {
    for layer in 0..order.len() {
        for at in 1..order[layer].len() {
            let before = crossings(slots, order);
            order[layer].swap(at - 1, at);
            if crossings(slots, order) >= before {
                order[layer].swap(at - 1, at);
            }
        }
    }
}

fn crossings(slots: &[Slot], order: &[Vec<usize>]) -> usize {
    let places = places(order, slots.len());
    let crossed = |layer: &Vec<usize>| {
        let ends: Vec<(usize, usize)> = layer
            .iter()
            .flat_map(|&at| slots[at].below.iter().map(move |&to| (at, to)))
            .map(|(a, b)| (places[a], places[b]))
            .collect();
        let pairs = ends.iter().enumerate().flat_map(|(i, a)| ends[i + 1..].iter().map(move |b| (a, b)));
        pairs.filter(|(a, b)| (a.0 < b.0 && a.1 > b.1) || (a.0 > b.0 && a.1 < b.1)).count()
    };
    order.iter().map(crossed).sum()
}

/// Place of each slot in its layer.
fn places(order: &[Vec<usize>], count: usize) -> Vec<usize> {
    let mut places = vec![0; count];
    for layer in order {
        layer.iter().enumerate().for_each(|(place, &at)| places[at] = place);
    }
    places
}

/// Sets the x of each slot: near the mean of its neighbours, in the given order and with [`GAP`] between.
fn place(slots: &mut [Slot], order: &mut [Vec<usize>]) {
    for layer in order.iter() {
        let wanted = vec![0.0; layer.len()];
        spread(slots, layer, &wanted);
    }
    for pass in 0..PASSES {
        for step in 0..order.len() {
            let layer = &order[if pass % 2 == 0 { step } else { order.len() - 1 - step }];
            // A slot that no dependency joins stands beside the one before it.
            let mut wanted: Vec<f64> = Vec::with_capacity(layer.len());
            for (place, &at) in layer.iter().enumerate() {
                let joined = slots[at].above.iter().chain(&slots[at].below).map(|&n| slots[n].x);
                let beside = place.checked_sub(1).map(|before| {
                    wanted[before] + (slots[layer[before]].width + slots[at].width) / 2.0 + GAP
                });
                wanted.push(mean(joined).or(beside).unwrap_or(slots[at].x));
            }
            spread(slots, layer, &wanted);
        }
    }
}

/// Least-squares places nearest to `wanted` that keep order and distances: pooled adjacent violators.
fn spread(slots: &mut [Slot], layer: &[usize], wanted: &[f64]) {
    let mut offsets = vec![0.0; layer.len()];
    for at in 1..layer.len() {
        offsets[at] = offsets[at - 1] + (slots[layer[at - 1]].width + slots[layer[at]].width) / 2.0 + GAP;
    }
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (offset, wanted) in offsets.iter().zip(wanted) {
        pools.push((wanted - offset, 1));
        while let [.., (before, many), (last, few)] = pools[..]
            && before > last
        {
            pools.truncate(pools.len() - 2);
            pools.push(((before * many as f64 + last * few as f64) / (many + few) as f64, many + few));
        }
    }
    let starts = pools.iter().flat_map(|&(start, count)| std::iter::repeat_n(start, count));
    for ((&at, offset), start) in layer.iter().zip(offsets).zip(starts) {
        slots[at].x = start + offset;
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}
