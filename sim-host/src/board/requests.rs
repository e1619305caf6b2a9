//! The requests that a board answers.

use super::client::{Client, ClientError};
use super::fault::Fault;
use super::parameter::{Parameter, law_bytes, law_of};
use super::printable::printable;
use control::Law;
use link::Key;
use link::message::Message;

/// Identity of the board's firmware.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct BoardName {
    /// The image's name.
    pub image: String,
    /// The program's version.
    pub version: String,
    /// The commit it was built from.
    pub commit: String,
    /// Identity of the active configuration: CRC-32 of its bytes, hexadecimal.
    pub configuration: String,
}

impl BoardName {
    /// A short label.
    pub fn label(&self) -> String {
        let Self { image, version, commit, configuration } = self;
        printable(&format!("{image} {version} commit {commit}, configuration {configuration}"))
    }
}

impl Client {
    /// The board's identity. The first request on a line: the answer shows whether both sides use the same link
    /// version.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn hello(&mut self) -> Result<BoardName, ClientError> {
        self.ask(&Message::AskHello, "hello", |answer| match answer {
            Message::Hello(hello) => Some(BoardName {
                image: hello.image.into(),
                version: hello.version.into(),
                commit: hello.commit.into(),
                configuration: format!("{:08x}", hello.config_hash),
            }),
            _ => None,
        })
    }

    /// All parameters, in the board's order.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn list(&mut self) -> Result<Vec<Parameter>, ClientError> {
        let mut listed = Vec::new();
        loop {
            let from = listed.len() as u16;
            let requested = format!("list from {from}");
            let (page, total) = self.ask(&Message::List { from }, &requested, |answer| match answer {
                Message::Page(page) if page.from == from => {
                    let entries: Vec<_> = page.entries().map(Parameter::from).collect();
                    let whole = entries.len() == usize::from(page.count);
                    let goes_on = !entries.is_empty() || from >= page.total;
                    (whole && goes_on).then_some((entries, page.total))
                }
                _ => None,
            })?;
            listed.extend(page);
            if listed.len() >= usize::from(total) {
                return Ok(listed);
            }
        }
    }

    /// A parameter's value.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn get(&mut self, key: &str) -> Result<Option<f32>, ClientError> {
        let request = Message::Get { key: Key::whole(key) };
        self.ask(&request, &format!("get {key}"), |answer| value_of(key, answer))
    }

    /// Sets a parameter and returns its value as read back.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn set(&mut self, key: &str, value: Option<f32>) -> Result<Option<f32>, ClientError> {
        let request = Message::Set { key: Key::whole(key), value };
        let requested = format!("set {key} to {}", value.map_or("none".into(), |value| value.to_string()));
        self.ask(&request, &requested, |answer| value_of(key, answer))
    }

    /// The law.
    ///
    /// # Errors
    /// See [`ClientError`]; `Mismatch` for a law that this program does not know.
    pub fn law(&mut self) -> Result<Law, ClientError> {
        self.ask(&Message::GetLaw, "get law", law_answered)
    }

    /// Sets the whole law and returns the law as read back.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn set_law(&mut self, law: &Law) -> Result<Law, ClientError> {
        self.ask(&Message::SetLaw(&law_bytes(law)), "set law", law_answered)
    }

    /// Stores the parameters in the board's flash.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn store(&mut self) -> Result<(), ClientError> {
        self.ask(&Message::Store, "store", done)
    }

    /// Sets all parameters to their defaults, without storing them in flash.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn reset(&mut self) -> Result<(), ClientError> {
        self.ask(&Message::Reset, "reset", done)
    }

    /// The stored fault records, newest first.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn faults(&mut self) -> Result<Vec<Fault>, ClientError> {
        let mut stored = Vec::new();
        loop {
            let from = stored.len() as u16;
            let requested = format!("list faults from {from}");
            let fault = self.ask(&Message::ListFaults { from }, &requested, |answer| match answer {
                Message::StoredFault(fault) if fault.place == from => Some(fault.record.map(Fault::from)),
                _ => None,
            })?;
            match fault {
                Some(fault) => stored.push(fault),
                None => return Ok(stored),
            }
        }
    }

    /// Erases the stored fault records.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn clear_faults(&mut self) -> Result<(), ClientError> {
        self.ask(&Message::ClearFaults, "clear faults", done)
    }
}

fn value_of(key: &str, answer: &Message<'_>) -> Option<Option<f32>> {
    match answer {
        Message::Value { key: of, value } if *of == Key::whole(key) => Some(*value),
        _ => None,
    }
}

fn law_answered(answer: &Message<'_>) -> Option<Law> {
    match answer {
        Message::Law(bytes) => law_of(bytes),
        _ => None,
    }
}

fn done(answer: &Message<'_>) -> Option<()> {
    (*answer == Message::Done).then_some(())
}
