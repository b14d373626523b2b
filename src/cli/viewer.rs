//! Which Rerun viewer to show something in.

use super::interrupt::Interrupt;
use super::output;
use super::report::WrittenFile;
use crate::archive::publish::Draft;
use crate::archive::sink::SinkError;
use crate::rerun::{Live, RerunError};
use anyhow::{Context as _, Error};
use clap::Args;
use std::net::SocketAddr;

/// Arguments of the commands that show something in a viewer.
#[derive(Args, Clone, Debug, PartialEq)]
pub(super) struct ViewerArguments {
    /// Show it in the Rerun viewer at this address.
    #[arg(long, value_name = "URL", num_args = 0..=1, require_equals = true,
          default_missing_value = "rerun+http://127.0.0.1:9876/proxy",
          conflicts_with_all = ["spawn", "serve"])]
    connect: Option<String>,

    /// Start a Rerun viewer and show it there.
    #[arg(long, conflicts_with = "serve")]
    spawn: bool,

    /// Serve the web viewer at this address, and its stream at the next port, until Ctrl-C (in builds with the
    /// feature web-viewer); 0.0.0.0 is every address of this machine.
    #[arg(long, value_name = "IP:PORT", num_args = 0..=1, require_equals = true,
          default_missing_value = "127.0.0.1:9090")]
    serve: Option<SocketAddr>,

    /// Draw the height of a free peg above the table by this factor: 1000 makes hops of micrometres visible.
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = parse_factor)]
    pub(super) hop_scale: f64,
}

/// Reads a factor by which hops are drawn higher.
fn parse_factor(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|factor: &f64| (1.0..=1e9).contains(factor))
        .ok_or_else(|| "must be a factor from 1 to 1e9".to_owned())
}

/// A viewer to show something in.
pub(super) enum Target {
    /// No viewer was asked for.
    None,
    /// A viewer that is there or can be started.
    Live(Live),
    /// A viewer that this process serves.
    #[cfg(feature = "web-viewer")]
    Served(crate::rerun::WebViewer),
}

impl ViewerArguments {
    /// Finds the viewer, or starts to serve it.
    pub(super) fn target(&self) -> Result<Target, Error> {
        if let Some(address) = self.serve {
            return serve(address);
        }
        Ok(match &self.connect {
            Some(url) => Target::Live(Live::Connect(url.clone())),
            None if self.spawn => Target::Live(Live::Spawn),
            None => Target::None,
        })
    }
}

#[cfg(feature = "web-viewer")]
fn serve(address: SocketAddr) -> Result<Target, Error> {
    let viewer = crate::rerun::WebViewer::start(address).map_err(Error::msg)?;
    output::announce(&format!("serving at {}", viewer.url));
    if !address.ip().is_loopback() {
        output::note("from another machine, put this one's name in both places of the address");
    }
    Ok(Target::Served(viewer))
}

#[cfg(not(feature = "web-viewer"))]
fn serve(_: SocketAddr) -> Result<Target, Error> {
    anyhow::bail!(
        "this build has no web viewer (it adds 40 MB): build it with --features web-viewer"
    )
}

/// Completes what a Rerun stream that has `ended` was written to: reports what happened to the viewer, and publishes the
/// file, if there is one.
pub(super) fn complete(
    ended: Result<Vec<String>, RerunError>,
    draft: Option<Draft>,
) -> Result<Option<WrittenFile>, Error> {
    let ended = ended.map_err(|error| SinkError::Viewer(Box::new(error)));
    let Some(draft) = draft else {
        output::warn_all(ended?);
        return Ok(None);
    };
    let path = draft.path().to_owned();
    let context = || format!("{} is not written", path.display());
    match ended {
        Ok(warnings) => output::warn_all(warnings),
        Err(error) => {
            draft.discard();
            return Err(error).with_context(context);
        }
    }
    WrittenFile::publish(draft).map(Some).with_context(context)
}

impl Target {
    /// The viewer to connect to.
    pub(super) fn live(&self) -> Option<Live> {
        match self {
            Self::None => None,
            Self::Live(live) => Some(live.clone()),
            #[cfg(feature = "web-viewer")]
            Self::Served(viewer) => Some(Live::Connect(viewer.address.clone())),
        }
    }

    /// Serves until Ctrl-C.
    #[cfg_attr(
        not(feature = "web-viewer"),
        allow(unused_variables, clippy::unused_self)
    )]
    pub(super) fn serve_until(self, interrupt: &Interrupt) {
        #[cfg(feature = "web-viewer")]
        if let Self::Served(viewer) = self {
            if !interrupt.is_asked() {
                output::note(&format!(
                    "still serving at {}; end it with Ctrl-C",
                    viewer.url
                ));
            }
            while !interrupt.is_asked() {
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
        }
    }
}
