//! Paths in a Rust source: those from the crate's root, and the first names of all.

use crate::Result;
use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A path into the own crate, from its root: `use super::x::{Y, Z}` in module `a::b` gives `a::x::Y` and `a::x::Z`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Path {
    /// Line of its first token, from 1.
    pub line: usize,
    /// Names from the crate's root; empty if it imports the root itself (`use crate::*`).
    pub names: Vec<String>,
}

/// The paths that start with `crate`, `self` or `super` in the source of `module`, also those inside macros.
/// Fails if the text is not made of Rust's tokens.
pub fn paths(text: &str, module: &[String]) -> Result<Vec<Path>> {
    let mut found = Vec::new();
    walk(&tokens(text)?, module, &mut found);
    Ok(found)
}

/// The first names of the paths that do not start with `crate`, `self` or `super`: `std` of `std::fs::read`.
pub fn first_names(text: &str) -> Result<Vec<String>> {
    let mut found = Vec::new();
    collect_first_names(&tokens(text)?, &mut found);
    Ok(found)
}

/// The re-exports of a crate's root, `pub use module::Name as Other`, as (`Other`, `module`).
pub fn re_exports(text: &str) -> Result<Vec<(String, String)>> {
    let tokens = tokens(text)?;
    let mut found = Vec::new();
    for at in 0..tokens.len() {
        if ident(&tokens, at).as_deref() == Some("use") {
            let mut leaves = Vec::new();
            tree(&tokens, at + 1, &[], &mut leaves);
            found.extend(leaves.into_iter().filter_map(|leaf| {
                let names: Vec<String> =
                    leaf.names.into_iter().filter(|n| n != "crate" && n != "self").collect();
                Some((leaf.alias.or_else(|| names.last().cloned())?, names.first()?.clone()))
            }));
        }
    }
    Ok(found)
}

fn tokens(text: &str) -> Result<Vec<TokenTree>> {
    let stream: TokenStream = text.parse().map_err(|error: proc_macro2::LexError| {
        format!("line {}: not Rust's tokens", error.span().start().line)
    })?;
    Ok(stream.into_iter().collect())
}

fn walk(tokens: &[TokenTree], module: &[String], found: &mut Vec<Path>) {
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        if let (Some("mod"), Some(name), Some(body)) =
            (ident(tokens, at).as_deref(), ident(tokens, at + 1), group(tokens, at + 2, Delimiter::Brace))
        {
            walk(&body, &[module, &[name]].concat(), found);
            at += 3;
        } else if is_path_start(tokens, at) {
            let mut leaves = Vec::new();
            let end = tree(tokens, at, &[], &mut leaves);
            // `pub(in super::super)` restricts, it does not import.
            if at == 0 || ident(tokens, at - 1).as_deref() != Some("in") {
                found.extend(
                    leaves
                        .into_iter()
                        .map(|leaf| Path { line: leaf.line, names: absolute(leaf.names, module) }),
                );
            }
            at = end;
        } else {
            if let TokenTree::Group(group) = token {
                walk(&group.stream().into_iter().collect::<Vec<_>>(), module, found);
            }
            at += 1;
        }
    }
}

fn is_path_start(tokens: &[TokenTree], at: usize) -> bool {
    matches!(ident(tokens, at).as_deref(), Some("crate" | "self" | "super")) && is_separator(tokens, at + 1)
}

/// One path of a `use` tree, or of an expression.
struct Leaf {
    line: usize,
    names: Vec<String>,
    alias: Option<String>,
}

/// Reads the path or `use` tree that starts at `at`, below `prefix`; returns the place after it.
fn tree(tokens: &[TokenTree], mut at: usize, prefix: &[String], leaves: &mut Vec<Leaf>) -> usize {
    let line = tokens.get(at).map_or(0, |token| token.span().start().line);
    let mut names = prefix.to_vec();
    loop {
        if let Some(name) = ident(tokens, at) {
            // `{self}` is what is before the braces.
            if name != "self" || names.is_empty() {
                names.push(name);
            }
            at += 1;
            if is_separator(tokens, at) {
                at += 2;
                continue;
            }
            let alias = (ident(tokens, at).as_deref() == Some("as")).then(|| ident(tokens, at + 1)).flatten();
            at += if alias.is_some() { 2 } else { 0 };
            leaves.push(Leaf { line, names, alias });
        } else if let Some(inner) = group(tokens, at, Delimiter::Brace) {
            let mut from = 0;
            while from < inner.len() {
                from = tree(&inner, from, &names, leaves);
                // To the next comma.
                while from < inner.len() && !punct(&inner, from, ',') {
                    from += 1;
                }
                from += 1;
            }
            at += 1;
        } else {
            // `*`, or a generic argument `::<T>`, whose types are read next.
            leaves.push(Leaf { line, names, alias: None });
        }
        return at;
    }
}

/// `crate`, `self` and each `super` at the start replaced by names from the root.
fn absolute(names: Vec<String>, module: &[String]) -> Vec<String> {
    let mut from_root: Vec<String> = Vec::new();
    for (place, name) in names.into_iter().enumerate() {
        match (place, name.as_str()) {
            (0, "crate") => {}
            (0, "self") => from_root = module.to_vec(),
            (0, "super") => from_root = module[..module.len().saturating_sub(1)].to_vec(),
            (_, "super") => drop(from_root.pop()),
            _ => from_root.push(name),
        }
    }
    from_root
}

fn collect_first_names(tokens: &[TokenTree], found: &mut Vec<String>) {
    for (at, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Group(group) => {
                collect_first_names(&group.stream().into_iter().collect::<Vec<_>>(), found);
            }
            TokenTree::Ident(name)
                if is_separator(tokens, at + 1) && *name != "use" && !continues(tokens, at) =>
            {
                found.push(name.to_string());
            }
            _ => {}
        }
    }
}

/// Whether the name at `at` is not the first of its path: `b` of `a::b` and of `<T>::b`, but not of `use ::b`.
fn continues(tokens: &[TokenTree], at: usize) -> bool {
    let Some(before) = at.checked_sub(3).filter(|_| is_separator(tokens, at - 2)) else { return false };
    punct(tokens, before, '>') || ident(tokens, before).is_some_and(|name| name != "use")
}

fn ident(tokens: &[TokenTree], at: usize) -> Option<String> {
    match tokens.get(at) {
        Some(TokenTree::Ident(name)) => Some(name.to_string()),
        _ => None,
    }
}

fn group(tokens: &[TokenTree], at: usize, delimiter: Delimiter) -> Option<Vec<TokenTree>> {
    match tokens.get(at) {
        Some(TokenTree::Group(group)) if group.delimiter() == delimiter => {
            Some(group.stream().into_iter().collect())
        }
        _ => None,
    }
}

fn is_separator(tokens: &[TokenTree], at: usize) -> bool {
    punct(tokens, at, ':') && punct(tokens, at + 1, ':')
}

fn punct(tokens: &[TokenTree], at: usize, sign: char) -> bool {
    matches!(tokens.get(at), Some(TokenTree::Punct(punct)) if punct.as_char() == sign)
}
