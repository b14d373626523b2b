//! Selection of the Rerun viewer.

use super::arguments::VIEWER;
use super::output;
use super::report::WrittenFile;
use crate::archive::publish::Draft;
use crate::archive::sink::SinkError;
use crate::rerun::{Live, RerunError};
use anyhow::{Context as _, Error};
use clap::Args;
use std::net::SocketAddr;

/// Viewer arguments.
#[derive(Args, Clone, Debug, PartialEq)]
pub(super) struct ViewerArguments {
    /// Connect to a running Rerun viewer [default URL: local viewer]
    #[arg(long, value_name = "URL", num_args = 0..=1, require_equals = true,
          default_missing_value = "rerun+http://127.0.0.1:9876/proxy",
          conflicts_with_all = ["spawn", "serve"], help_heading = VIEWER)]
    connect: Option<String>,

    /// Start a Rerun viewer
    #[arg(long, conflicts_with = "serve", help_heading = VIEWER)]
    spawn: bool,

    /// Serve the web viewer at this address until Ctrl-C; its data uses the next port (needs the feature web-viewer).
    #[arg(long, value_name = "IP:PORT", num_args = 0..=1, require_equals = true,
          default_missing_value = "127.0.0.1:9090", help_heading = VIEWER)]
    serve: Option<SocketAddr>,
}

/// A viewer to show something in, if one was asked for.
pub(super) struct Target {
    /// A running viewer, or one to start.
    pub(super) live: Option<Live>,
    /// The web viewer behind it, if this process serves it.
    #[cfg(feature = "web-viewer")]
    served: Option<crate::rerun::WebViewer>,
}

impl ViewerArguments {
    /// Finds the viewer, or starts to serve it.
    pub(super) fn target(&self) -> Result<Target, Error> {
        if let Some(address) = self.serve {
            return serve(address);
        }
        let connect = self.connect.clone().map(Live::Connect);
        Ok(Target::of(connect.or(self.spawn.then_some(Live::Spawn))))
    }
}

#[cfg(feature = "web-viewer")]
fn serve(address: SocketAddr) -> Result<Target, Error> {
    let viewer = crate::rerun::WebViewer::start(address).map_err(Error::msg)?;
    output::announce(&format!("serving at {}", viewer.url));
    if !address.ip().is_loopback() {
        output::note("from another machine, replace the host name in both parts of the URL");
    }
    Ok(Target {
        live: Some(Live::Connect(viewer.address.clone())),
        served: Some(viewer),
    })
}

#[cfg(not(feature = "web-viewer"))]
fn serve(_: SocketAddr) -> Result<Target, Error> {
    anyhow::bail!("this build has no web viewer; rebuild with --features web-viewer (adds 40 MB)")
}

/// Finishes a Rerun stream: prints viewer warnings and publishes the file, if there is one.
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
    /// A viewer that this process doesn't serve.
    pub(super) fn of(live: Option<Live>) -> Self {
        Self {
            live,
            #[cfg(feature = "web-viewer")]
            served: None,
        }
    }

    /// Serves the web viewer, if it was asked for, until Ctrl-C.
    #[cfg_attr(
        not(feature = "web-viewer"),
        allow(clippy::unused_self, clippy::unnecessary_wraps)
    )]
    pub(super) fn serve_until_interrupted(&self) -> Result<(), Error> {
        #[cfg(feature = "web-viewer")]
        if let Some(viewer) = &self.served {
            super::interrupt::watch()?;
            if !super::interrupt::is_requested() {
                output::note(&format!(
                    "still serving at {}; press Ctrl-C to stop",
                    viewer.url
                ));
            }
            while !super::interrupt::is_requested() {
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
        }
        Ok(())
    }
}
