//! Live viewers.

use std::net::{TcpStream, ToSocketAddrs as _};
use std::str::FromStr as _;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use rerun::external::re_log_types::LogMsg;
use rerun::external::re_uri::ProxyUri;
use rerun::sink::{GrpcSink, GrpcSinkConnectionState, LogSink as _};

use super::message::QUEUE;

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
    end: Receiver<Result<(), String>>,
}

impl LiveDestination {
    /// Finds or starts the viewer. The error is a sentence.
    pub(super) fn open(live: &Live) -> Result<Self, String> {
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
            .map_err(|error| format!("cannot start a thread for the Rerun viewer: {error}"))?;
        Ok(Self {
            address,
            queue,
            end,
        })
    }

    /// Passes a message on, waiting for room in the queue while the viewer makes progress.
    pub(super) fn send(&self, mut message: LogMsg) -> Result<(), String> {
        let start = Instant::now();
        loop {
            message = match self.queue.try_send(message) {
                Ok(()) => return Ok(()),
                Err(TrySendError::Disconnected(_)) => {
                    let end = self.end.recv_timeout(CONNECT);
                    let reason = end.ok().and_then(Result::err);
                    let reason = reason.as_deref().unwrap_or("the connection broke");
                    return Err(lost(&self.address, reason));
                }
                Err(TrySendError::Full(_)) if start.elapsed() > STALL => {
                    return Err(format!(
                        "the Rerun viewer at {} did not respond for {} s and was disconnected",
                        self.address,
                        STALL.as_secs()
                    ));
                }
                Err(TrySendError::Full(back)) => back,
            };
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Waits until the viewer has received everything, for a few seconds at most.
    pub(super) fn finish(self) -> Result<(), String> {
        drop(self.queue);
        match self.end.recv_timeout(FINISH) {
            Ok(end) => end.map_err(|reason| lost(&self.address, &reason)),
            Err(_) => Err(format!(
                "the Rerun viewer at {} did not accept the end of the recording within {} s",
                self.address,
                FINISH.as_secs()
            )),
        }
    }
}

fn lost(address: &str, reason: &str) -> String {
    format!(
        "the connection to the Rerun viewer at {address} was lost ({reason}); it shows only part of the run"
    )
}

/// Sends messages to a viewer until there are no more, and waits until it has received them all.
fn feed(uri: ProxyUri, messages: &Receiver<LogMsg>) -> Result<(), String> {
    let sink = GrpcSink::new(uri);
    for message in messages {
        sink.send(message);
        if let GrpcSinkConnectionState::Disconnected(_) = sink.status() {
            return Err("the connection broke".to_owned());
        }
    }
    sink.flush_blocking(FINISH).map_err(|e| e.to_string())
}

/// Parses an address: a URL as printed by `rerun`, or `HOST:PORT`.
fn parse_address(address: &str) -> Result<ProxyUri, String> {
    let full = if address.contains("://") {
        address.to_owned()
    } else {
        format!("rerun+http://{address}/proxy")
    };
    ProxyUri::from_str(&full)
        .map_err(|error| format!("{address:?} is not a valid Rerun viewer address: {error}"))
}

/// Retries the connection until `timeout`; the SDK client would retry forever.
fn wait_for_viewer(uri: &ProxyUri, patience: Duration) -> Result<(), String> {
    let start = Instant::now();
    loop {
        match knock(uri) {
            Ok(()) => return Ok(()),
            Err(error) if start.elapsed() >= patience => {
                return Err(format!("no Rerun viewer at {uri}: {error}"));
            }
            Err(_) => thread::sleep(Duration::from_millis(100)),
        }
    }
}

fn knock(uri: &ProxyUri) -> std::io::Result<()> {
    let host = uri.origin.host.to_string();
    // Strip the brackets of an IPv6 address for the resolver.
    let host = host.trim_start_matches('[').trim_end_matches(']');
    let mut result = Err(std::io::ErrorKind::NotFound.into());
    for address in (host, uri.origin.port).to_socket_addrs()? {
        result = TcpStream::connect_timeout(&address, CONNECT).map(drop);
        if result.is_ok() {
            break;
        }
    }
    result
}

/// Starts a viewer that listens on this machine only.
fn spawn_viewer() -> Result<ProxyUri, String> {
    let options = rerun::SpawnOptions {
        extra_args: vec!["--bind=127.0.0.1".to_owned()],
        hide_welcome_screen: true,
        ..Default::default()
    };
    rerun::spawn(&options).map_err(|error| match error {
        rerun::SpawnError::ExecutableNotFoundInPath { .. } => MISSING_VIEWER.to_owned(),
        other => other.to_string(),
    })?;
    parse_address(&options.connect_addr().to_string())
}

/// Advice if no viewer is installed.
pub const MISSING_VIEWER: &str = "\
no executable `rerun` in PATH. Install the viewer with
    pip install rerun-sdk==0.36.3
or
    cargo install rerun-cli --version 0.36.3 --locked";
