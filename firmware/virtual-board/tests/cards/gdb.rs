//! The host's files for an image that runs with semihosting: a client of the emulator's GDB server that answers its file
//! calls ("Debugging with GDB", appendix E, File-I/O).

use std::collections::HashMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};

/// Flags of the protocol's `open`.
const CREATE: u64 = 0x200;
const TRUNCATE: u64 = 0x400;
/// Largest number of bytes of memory in one packet of 4096, two digits each.
const CHUNK: usize = 1024;

/// A client that runs the core and serves files of one directory until the run ends.
pub(crate) struct FileHost {
    stream: TcpStream,
    directory: PathBuf,
    files: HashMap<u64, File>,
    next: u64,
}

impl FileHost {
    pub(crate) fn connect(server: SocketAddr, directory: &Path) -> std::io::Result<Self> {
        let stream = TcpStream::connect(server)?;
        Ok(Self { stream, directory: directory.to_owned(), files: HashMap::new(), next: 3 })
    }

    /// Serves until the program exits or the connection ends; returns the exit code, if any.
    pub(crate) fn serve(mut self) -> std::io::Result<Option<u8>> {
        self.send("c")?;
        loop {
            let packet = self.receive()?;
            match packet.split_at_checked(1) {
                Some(("F", call)) => {
                    let answer =
                        self.call(call).map_or_else(|_| "F-1,2".into(), |result| format!("F{result:x}"));
                    self.send(&answer)?;
                }
                Some(("W", code)) => return Ok(u8::from_str_radix(code, 16).ok()),
                Some(("O", _)) => (),
                _ => return Ok(None),
            }
        }
    }

    fn call(&mut self, call: &str) -> std::io::Result<u64> {
        let mut fields = call.split(',');
        let name = fields.next().unwrap_or_default();
        let numbers: Vec<u64> = fields
            .flat_map(|field| field.split('/'))
            .map(|field| u64::from_str_radix(field, 16).unwrap_or(0))
            .collect();
        match (name, numbers.as_slice()) {
            ("open", [path, length, flags, ..]) => {
                let mut name = self.peek(*path, *length as usize)?;
                name.retain(|byte| *byte != 0);
                let file = self.directory.join(String::from_utf8_lossy(&name).as_ref());
                let writes = flags & 3 != 0;
                let opened = File::options()
                    .read(true)
                    .write(writes)
                    .create(writes && flags & CREATE != 0)
                    .truncate(writes && flags & TRUNCATE != 0)
                    .open(file)?;
                self.next += 1;
                self.files.insert(self.next, opened);
                Ok(self.next)
            }
            ("close", [file]) => {
                self.files.remove(file);
                Ok(0)
            }
            ("read", [file, at, length]) => {
                let mut bytes = vec![0; *length as usize];
                let got = self.file(*file)?.read(&mut bytes)?;
                self.poke(*at, &bytes[..got])?;
                Ok(got as u64)
            }
            ("write", [file, at, length]) => {
                let bytes = self.peek(*at, *length as usize)?;
                self.file(*file)?.write_all(&bytes)?;
                Ok(*length)
            }
            ("lseek", [file, to, from]) => {
                let position = match from {
                    0 => SeekFrom::Start(*to),
                    1 => SeekFrom::Current(*to as i64),
                    _ => SeekFrom::End(*to as i64),
                };
                self.file(*file)?.seek(position)
            }
            _ => Err(std::io::ErrorKind::Unsupported.into()),
        }
    }

    fn file(&mut self, number: u64) -> std::io::Result<&mut File> {
        self.files.get_mut(&number).ok_or(std::io::ErrorKind::NotFound.into())
    }

    fn peek(&mut self, at: u64, length: usize) -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        while bytes.len() < length {
            let part = (length - bytes.len()).min(CHUNK);
            self.send(&format!("m{:x},{part:x}", at + bytes.len() as u64))?;
            let digits = self.receive()?;
            let pairs = digits
                .as_bytes()
                .chunks_exact(2)
                .map(|pair| u8::from_str_radix(&String::from_utf8_lossy(pair), 16).unwrap_or(0));
            let before = bytes.len();
            bytes.extend(pairs);
            if bytes.len() == before {
                return Err(std::io::ErrorKind::InvalidData.into());
            }
        }
        Ok(bytes)
    }

    fn poke(&mut self, at: u64, bytes: &[u8]) -> std::io::Result<()> {
        for (number, part) in bytes.chunks(CHUNK).enumerate() {
            let digits: String = part.iter().map(|byte| format!("{byte:02x}")).collect();
            self.send(&format!("M{:x},{:x}:{digits}", at + (number * CHUNK) as u64, part.len()))?;
            self.receive()?;
        }
        Ok(())
    }

    fn send(&mut self, packet: &str) -> std::io::Result<()> {
        let sum = packet.bytes().fold(0_u8, u8::wrapping_add);
        write!(self.stream, "${packet}#{sum:02x}")
    }

    /// The next packet, acknowledged; acknowledgements of the other side are skipped.
    fn receive(&mut self) -> std::io::Result<String> {
        let mut byte = [0];
        while byte != *b"$" {
            self.stream.read_exact(&mut byte)?;
        }
        let mut packet = Vec::new();
        loop {
            self.stream.read_exact(&mut byte)?;
            if byte == *b"#" {
                break;
            }
            packet.push(byte[0]);
        }
        self.stream.read_exact(&mut [0; 2])?;
        self.stream.write_all(b"+")?;
        Ok(String::from_utf8_lossy(&packet).into_owned())
    }
}
