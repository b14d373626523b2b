//! The web viewer, served by this process: a page, and the stream that it shows.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};

use rerun::grpc_server::GrpcServerSink;
use rerun::web_viewer::WebViewerConfig;

/// Buffer size of the server for viewers that connect later, bytes.
const MEMORY: u64 = 2 << 30;

/// A server of the viewer's page and of the stream that it shows, until it is dropped.
pub struct WebViewer {
    // Both serve until they are dropped.
    _stream: GrpcServerSink,
    _page: Box<dyn std::any::Any>,
    /// The address that sinks connect to.
    pub address: String,
    /// The address to open in a browser.
    pub url: String,
}

impl WebViewer {
    /// Serves the page at an address and the stream at the next port.
    ///
    /// # Errors
    /// A description of the error.
    pub fn start(address: SocketAddr) -> Result<Self, String> {
        let (bind, port) = (address.ip(), address.port());
        let stream_port = port
            .checked_add(1)
            .ok_or("port 65535 can't be used, because the stream needs the next port")?;
        for port in [port, stream_port] {
            check_free(SocketAddr::new(bind, port))?;
        }
        let options = rerun::ServerOptions {
            memory_limit: rerun::MemoryLimit::from_bytes(MEMORY),
            // By default only pages of this machine may read the stream.
            cors_allowed_origins: if bind.is_loopback() {
                Vec::new()
            } else {
                vec![format!("http://*:{port}")]
            },
            ..Default::default()
        };
        let host = if bind.is_unspecified() {
            Ipv4Addr::LOCALHOST.into()
        } else {
            bind
        };
        let [page_address, stream_address] =
            [port, stream_port].map(|port| SocketAddr::new(host, port));
        let stream = GrpcServerSink::new(&bracketed(bind), stream_port, options)
            .map_err(|error| error.to_string())?;
        let address = format!("rerun+http://{stream_address}/proxy");
        let page = WebViewerConfig {
            bind_ip: bracketed(bind),
            web_port: port.into(),
            open_browser: false,
            ..Default::default()
        };
        let page = page
            .host_web_viewer()
            .map_err(|error| format!("cannot serve the web viewer: {error}"))?;
        let encoded = address
            .replace('+', "%2B")
            .replace(':', "%3A")
            .replace('/', "%2F");
        Ok(Self {
            _stream: stream,
            _page: Box::new(page),
            url: format!("http://{page_address}/?url={encoded}"),
            address,
        })
    }
}

/// Checks that an address is free; the SDK's servers only log such errors.
fn check_free(address: SocketAddr) -> Result<(), String> {
    match TcpListener::bind(address) {
        Ok(_) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::AddrInUse => Err(format!(
            "port {} is in use: choose another with --serve=IP:PORT (the stream uses the next port)",
            address.port()
        )),
        Err(error) => Err(format!("cannot listen on {address}: {error}")),
    }
}

/// An IP address in URL notation.
fn bracketed(ip: IpAddr) -> String {
    match ip {
        IpAddr::V4(ip) => ip.to_string(),
        IpAddr::V6(ip) => format!("[{ip}]"),
    }
}
