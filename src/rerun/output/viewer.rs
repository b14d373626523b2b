//! Live viewers.

use std::io;
use std::net::{TcpStream, ToSocketAddrs as _};
use std::str::FromStr as _;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use rerun::external::re_log_types::LogMsg;
use rerun::external::re_uri::ProxyUri;
use rerun::sink::{GrpcSink, GrpcSinkConnectionState, LogSink as _};

use super::message::QUEUE;
use crate::rerun::error::ViewerError;

/// Timeout for connecting to a running viewer.
const CONNECT: Duration = Duration::from_secs(1);
/// Timeout for a viewer that was just started.
const START: Duration = Duration::from_secs(10);
/// Timeout for a viewer that stops reading.
const STALL: Duration = Duration::from_secs(3);
/// Timeout for sending the last messages.
const FINISH: Duration = Duration::from_secs(5);

/// The viewer to send to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Live {
    /// The viewer at this address: `rerun+http://HOST:PORT/proxy`, or `HOST:PORT` for short.
    Connect(String),
    /// A viewer on this machine, started if none listens on the default port.
    Spawn,
}

/// A viewer, and the thread that sends data to it.
///
/// The SDK client blocks if the viewer stops reading, so it runs on its own thread that can be abandoned.
pub(super) struct LiveDestination {
    address: String,
    queue: SyncSender<LogMsg>,
    end: Receiver<Result<(), ViewerError>>,
}

impl LiveDestination {
    /// Finds or starts the viewer.
    pub(super) fn open(live: &Live) -> Result<Self, ViewerError> {
        let (uri, patience) = match live {
            Live::Connect(address) => (parse_address(address)?, CONNECT),
            Live::Spawn => (spawn_viewer()?, START),
        };
        wait_for_viewer(&uri, patience)?;
        let address = uri.to_string();
        let (queue, messages) = sync_channel(QUEUE);
        let (report, end) = sync_channel(1);
        thread::Builder::new()
            .name("rerun feeder".to_owned())
            .spawn(move || {
                // The receiver is gone if the viewer was abandoned.
                let _ = report.send(feed(uri, &messages));
            })
            .map_err(ViewerError::Thread)?;
        Ok(Self {
            address,
            queue,
            end,
        })
    }

    /// Passes a message on, waiting for room in the queue while the viewer makes progress.
    pub(super) fn send(&self, mut message: LogMsg) -> Result<(), ViewerError> {
        let start = Instant::now();
        loop {
            message = match self.queue.try_send(message) {
                Ok(()) => return Ok(()),
                Err(TrySendError::Disconnected(_)) => {
                    // The thread has ended, so its reason is there or arrives at once.
                    let ended = self.end.recv_timeout(CONNECT);
                    return Err(match ended {
                        Ok(Err(reason)) => reason,
                        Ok(Ok(())) | Err(_) => self.disconnected(),
                    });
                }
                Err(TrySendError::Full(_)) if start.elapsed() > STALL => {
                    return Err(ViewerError::Stalled {
                        address: self.address.clone(),
                        patience: STALL,
                    });
                }
                Err(TrySendError::Full(back)) => back,
            };
            // `SyncSender` has no way to wait for room for a limited time.
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Waits until the viewer has received everything, for a few seconds at most.
    pub(super) fn finish(self) -> Result<(), ViewerError> {
        drop(self.queue);
        match self.end.recv_timeout(FINISH) {
            Ok(ended) => ended,
            Err(_) => Err(ViewerError::Unfinished {
                address: self.address,
                patience: FINISH,
            }),
        }
    }

    fn disconnected(&self) -> ViewerError {
        ViewerError::Disconnected {
            address: self.address.clone(),
        }
    }
}

/// Sends messages to a viewer until there are no more, and waits until it has received them all.
fn feed(uri: ProxyUri, messages: &Receiver<LogMsg>) -> Result<(), ViewerError> {
    let address = uri.to_string();
    let sink = GrpcSink::new(uri);
    for message in messages {
        sink.send(message);
        // `send` can't fail: it drops what it can't send.
        if let GrpcSinkConnectionState::Disconnected(_) = sink.status() {
            return Err(ViewerError::Disconnected { address });
        }
    }
    sink.flush_blocking(FINISH)
        .map_err(|reason| ViewerError::Flush { address, reason })
}

/// Parses an address: a URL as printed by `rerun`, or `HOST:PORT`.
fn parse_address(address: &str) -> Result<ProxyUri, ViewerError> {
    let full = if address.contains("://") {
        address.to_owned()
    } else {
        format!("rerun+http://{address}/proxy")
    };
    ProxyUri::from_str(&full).map_err(|reason| ViewerError::Address {
        address: address.to_owned(),
        reason: Box::new(reason),
    })
}

/// Retries the connection for some time; the SDK client would retry forever.
fn wait_for_viewer(uri: &ProxyUri, patience: Duration) -> Result<(), ViewerError> {
    let start = Instant::now();
    loop {
        match try_connect(uri) {
            Ok(()) => return Ok(()),
            Err(reason) if start.elapsed() >= patience => {
                let address = uri.to_string();
                return Err(ViewerError::Absent { address, reason });
            }
            Err(_) => thread::sleep(Duration::from_millis(100)),
        }
    }
}

fn try_connect(uri: &ProxyUri) -> io::Result<()> {
    let host = uri.origin.host.to_string();
    // The resolver takes an IPv6 address without brackets.
    let name = host.trim_start_matches('[').trim_end_matches(']');
    let mut result = Err(io::ErrorKind::NotFound.into());
    for address in (name, uri.origin.port).to_socket_addrs()? {
        result = TcpStream::connect_timeout(&address, CONNECT).map(drop);
        if result.is_ok() {
            break;
        }
    }
    result
}

/// Starts a viewer that listens on this machine only.
fn spawn_viewer() -> Result<ProxyUri, ViewerError> {
    let options = rerun::SpawnOptions {
        // A viewer listens on all network interfaces otherwise.
        extra_args: vec!["--bind=127.0.0.1".to_owned()],
        hide_welcome_screen: true,
        ..Default::default()
    };
    rerun::spawn(&options).map_err(|error| match error {
        rerun::SpawnError::ExecutableNotFoundInPath { .. } => ViewerError::NotInstalled,
        other => ViewerError::Spawn(other),
    })?;
    parse_address(&options.connect_addr().to_string())
}
