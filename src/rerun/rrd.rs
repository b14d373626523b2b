//! `.rrd` files, each written by a thread that encodes and compresses.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Seek as _, Write};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use rerun::external::arrow::datatypes::{FieldRef, Schema};
use rerun::external::re_log_encoding::rrd::{
    Decodable as _, Encodable as _, EncodingOptions, MessageHeader, MessageKind, RrdFooter,
    StreamFooter,
};
use rerun::external::re_log_encoding::{Encoder, ToApplication as _, ToTransport};
use rerun::external::re_log_types::LogMsg;

use super::error::RerunError;
use super::message::QUEUE;

/// An `.rrd` file that is being written.
pub(super) struct RrdFile {
    queue: SyncSender<LogMsg>,
    worker: JoinHandle<Result<(), RerunError>>,
}

impl RrdFile {
    /// Starts the thread that writes into `file`.
    pub(super) fn open(file: File) -> Result<Self, RerunError> {
        let (queue, messages) = sync_channel(QUEUE);
        let worker = thread::Builder::new()
            .name("rrd encoder".to_owned())
            .spawn(move || encode(file, &messages))?;
        Ok(Self { queue, worker })
    }

    /// Passes a message on, unless writing has failed; [`Self::finish`] returns the reason.
    pub(super) fn send(&self, message: LogMsg) -> bool {
        self.queue.send(message).is_ok()
    }

    /// Waits until all messages and the footer are in the file.
    pub(super) fn finish(self) -> Result<(), RerunError> {
        drop(self.queue);
        self.worker.join().map_err(|_| RerunError::Worker)?
    }
}

/// Encodes messages until there are no more, then adds the footer.
fn encode(file: File, messages: &Receiver<LogMsg>) -> Result<(), RerunError> {
    let mut file = BufWriter::new(file);
    let encoded = Encoded::default();
    let version = rerun::build_info().version;
    let options = EncodingOptions::PROTOBUF_COMPRESSED;
    let mut encoder = Encoder::new_eager(version, options, encoded.clone())?;
    encoded.pass_on(&mut file)?;
    for message in messages {
        encoder.append(&message)?;
        encoded.pass_on(&mut file)?;
    }
    encoder.finish()?;
    let length = file.stream_position()?;
    file.write_all(&in_fixed_order(&encoded.0.borrow(), length)?)?;
    Ok(file.flush()?)
}

/// The bytes that the encoder has written since they were last passed on.
#[derive(Clone, Default)]
struct Encoded(Rc<RefCell<Vec<u8>>>);

impl Encoded {
    /// Writes the bytes into a file.
    fn pass_on(&self, file: &mut impl Write) -> io::Result<()> {
        let bytes = self.0.take();
        file.write_all(&bytes)
    }
}

impl Write for Encoded {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The `end` of a file, from byte `start` on, in deterministic order; the SDK's encoder uses hash map order.
///
/// The end consists of a message header, the footer with a manifest per store, and the place of the footer.
fn in_fixed_order(end: &[u8], start: u64) -> Result<Vec<u8>, RerunError> {
    type Footer = <RrdFooter as ToTransport>::Output;

    let header = MessageHeader::ENCODED_SIZE_BYTES;
    let MessageHeader { len, .. } = MessageHeader::from_rrd_bytes(&end[..header])?;
    let footer = Footer::from_rrd_bytes(&end[header..][..len as usize])?.to_application(())?;
    let manifests = BTreeMap::from_iter(footer.manifests).into_values();
    let manifests = manifests.map(|mut manifest| {
        manifest.sorbet_schema = with_sorted_columns(&manifest.sorbet_schema);
        manifest.to_transport(())
    });
    let footer = Footer {
        manifests: manifests.collect::<Result<_, _>>()?,
    };
    let mut bytes = Vec::new();
    let len = footer.to_rrd_bytes(&mut bytes)?;
    let kind = MessageKind::End;
    let mut end = Vec::with_capacity(bytes.len() + 64);
    MessageHeader { kind, len }.to_rrd_bytes(&mut end)?;
    end.extend_from_slice(&bytes);
    StreamFooter::from_rrd_footer_bytes(start + header as u64, &bytes).to_rrd_bytes(&mut end)?;
    Ok(end)
}

/// A schema with its columns sorted by name; no two have the same.
fn with_sorted_columns(schema: &Schema) -> Schema {
    let mut columns: Vec<FieldRef> = schema.fields.iter().map(Arc::clone).collect();
    columns.sort_by(|one, other| one.name().cmp(other.name()));
    Schema::new_with_metadata(columns, schema.metadata.clone())
}
