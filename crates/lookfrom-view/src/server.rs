//! The server: page, assets and socket, for whoever knows the token.
//!
//! Other sites' pages can send requests to a local port, but they cannot read the token; and a page of a name that was bound
//! to this address (DNS rebinding) has that name as its `Host` and `Origin`. Both are refused.

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::ws::{CloseFrame, Message, WebSocketUpgrade, close_code};
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use lookfrom_scene::Disk;
use serde::Deserialize;

use crate::Settings;
use crate::assets::asset;
use crate::document::Document;
use crate::message::LONGEST;
use crate::patience::{self, PatientListener};
use crate::window::{self, Counted};

/// The most windows at once.
const MOST_WINDOWS: usize = 16;

/// The interval at which the server looks whether to end.
const LOOK: Duration = Duration::from_millis(100);

/// The longest wait for the threads of windows at the end.
const PATIENCE: Duration = Duration::from_secs(5);

/// The page's content security policy: nothing is loaded from elsewhere.
const POLICY: &str =
    "default-src 'self'; img-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors ";

/// Who may show the page in a frame where that is allowed: pages of this machine, and those of notebooks in VS Code.
const FRAMES: &str = "http://localhost:* http://127.0.0.1:* vscode-webview:";

/// The address at which a page is served.
#[derive(Clone, Copy, Debug)]
pub struct Address {
    /// The address to listen at.
    pub host: IpAddr,
    /// The port; 0 for any that is free.
    pub port: u16,
    /// Whether pages of this machine, such as notebooks, may show it in a frame.
    pub may_be_framed: bool,
}

/// A server of one scene, bound to its address.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    state: Arc<ServerState>,
    patience: Duration,
}

/// State shared by all requests.
#[derive(Debug)]
struct ServerState {
    token: String,
    policy: HeaderValue,
    host: IpAddr,
    document: Arc<Document>,
    /// Windows whose threads have not ended.
    windows: Arc<AtomicUsize>,
}

impl Server {
    /// Binds the address. Nothing is read yet.
    ///
    /// # Errors
    /// An error where the address is in use or not this machine's, or where the system has no entropy for a token.
    pub fn bind(settings: Settings, at: Address) -> io::Result<Self> {
        let listener = TcpListener::bind((at.host, at.port))?;
        let address = listener.local_addr()?;
        let mut bits = [0; 16];
        getrandom::fill(&mut bits).map_err(io::Error::other)?;
        let token = bits.iter().map(|byte| format!("{byte:02x}")).collect();
        let ancestors = if at.may_be_framed { FRAMES } else { "'none'" };
        let policy = HeaderValue::try_from(format!("{POLICY}{ancestors}")).map_err(io::Error::other)?;
        let (host, windows) = (at.host, Arc::default());
        let document = Arc::new(Document::new(settings, Arc::new(Disk)));
        let state = Arc::new(ServerState { token, policy, host, document, windows });
        Ok(Self { listener, address, state, patience: patience::PATIENCE })
    }

    /// Sets the longest silence of a client: one that sends nothing, not even answers to pings, or reads nothing
    /// for so long is dropped.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Self {
        Self { patience, ..self }
    }

    /// The address of the page, with the token.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            let loopback: IpAddr =
                if address.is_ipv4() { [127, 0, 0, 1].into() } else { [0, 0, 0, 0, 0, 0, 0, 1].into() };
            address.set_ip(loopback);
        }
        format!("http://{address}/?token={}", self.state.token)
    }

    /// A counter of the windows whose threads have not ended.
    pub fn windows(&self) -> Arc<AtomicUsize> {
        self.state.windows.clone()
    }

    /// Serves until `stopped`. Then all renders end.
    ///
    /// # Errors
    /// An error where the system refuses to listen or to start threads.
    pub fn run(self, stopped: impl Fn() -> bool + Sync) -> io::Result<()> {
        let Self { listener, state, patience, .. } = self;
        listener.set_nonblocking(true)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        std::thread::scope(|scope| {
            let watching = std::thread::Builder::new().name("watch".to_owned());
            watching.spawn_scoped(scope, || state.document.watch(&stopped))?;
            let windows = state.windows.clone();
            let served = runtime.block_on(async {
                let listener = tokio::net::TcpListener::from_std(listener)?;
                let listener = PatientListener { listener, patience };
                tokio::select! {
                    served = axum::serve(listener, router(state.clone(), patience)) => served,
                    () = ended(&stopped) => Ok(()),
                }
            });
            // The tasks of the sockets end, and tell their windows.
            drop(runtime);
            let started = Instant::now();
            while windows.load(Ordering::Acquire) > 0 && started.elapsed() < PATIENCE {
                std::thread::sleep(LOOK / 10);
            }
            served
        })
    }
}

async fn ended(stopped: &impl Fn() -> bool) {
    while !stopped() {
        tokio::time::sleep(LOOK).await;
    }
}

fn router(state: Arc<ServerState>, patience: Duration) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/socket", get(move |state, query, upgrade| socket(state, query, upgrade, patience)))
        .route("/{*name}", get(file))
        .layer(middleware::from_fn_with_state(state.clone(), require_same_origin))
        .with_state(state)
}

/// The query of addresses that need the token.
#[derive(Deserialize)]
struct Token {
    #[serde(default)]
    token: String,
}

impl ServerState {
    /// Whether a token is this server's, in a time that does not depend on where it differs.
    fn knows(&self, token: &str) -> bool {
        let differences = self.token.bytes().zip(token.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
        self.token.len() == token.len() && differences == 0
    }

    /// Whether a `Host` is an address by which this server may be asked for. The port may be another one: that of a tunnel.
    fn is_host(&self, host: &str) -> bool {
        let name = match host.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            Some((name, _)) => name,
            None => host.split(':').next().unwrap_or_default(),
        };
        if name.eq_ignore_ascii_case("localhost") {
            return true;
        }
        // A name that was bound to this address is no number.
        name.parse::<IpAddr>()
            .is_ok_and(|ip| ip.is_loopback() || ip == self.host || self.host.is_unspecified())
    }

    /// Whether a request asks for this server, and not by another site's page.
    fn is_same_origin(&self, headers: &HeaderMap) -> bool {
        let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or_default());
        let host = text(header::HOST).unwrap_or_default();
        let is_ours = |origin: &str| origin.strip_prefix("http://") == Some(host);
        self.is_host(host) && text(header::ORIGIN).is_none_or(is_ours)
    }
}

/// Refuses requests to other hosts and from other sites' pages, and tells the browser what the page may do.
async fn require_same_origin(
    State(state): State<Arc<ServerState>>,
    request: Request,
    next: Next,
) -> Response {
    if !state.is_same_origin(request.headers()) {
        return (StatusCode::FORBIDDEN, "another host or origin\n").into_response();
    }
    let mut response = next.run(request).await;
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, state.policy.clone());
    for (name, value) in [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
    ] {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn page(State(state): State<Arc<ServerState>>, Query(query): Query<Token>) -> Response {
    match state.knows(&query.token) {
        true => found("index.html"),
        false => no_token(),
    }
}

async fn file(Path(name): Path<String>) -> Response {
    found(&name)
}

async fn socket(
    State(state): State<Arc<ServerState>>,
    Query(query): Query<Token>,
    upgrade: WebSocketUpgrade,
    patience: Duration,
) -> Response {
    if !state.knows(&query.token) {
        return no_token();
    }
    let Some(counted) = Counted::new(&state.windows, MOST_WINDOWS) else {
        // A page cannot read why a connection was refused, so it is made, and closed with the reason.
        let reason = format!("{MOST_WINDOWS} windows are open: close one").into();
        let close = CloseFrame { code: close_code::AGAIN, reason };
        return upgrade.on_upgrade(|mut socket| async move {
            // Who is gone need not be told.
            let _ = socket.send(Message::Close(Some(close))).await;
        });
    };
    // Longer messages than the longest are read, so that they can be answered, up to a limit.
    let upgrade = upgrade.max_message_size(16 * LONGEST).max_frame_size(16 * LONGEST);
    upgrade.on_upgrade(move |socket| window::run(socket, state.document.clone(), counted, patience / 3))
}

fn no_token() -> Response {
    let message = "this address needs its token: open the one that `lookfrom view` printed\n";
    (StatusCode::FORBIDDEN, message).into_response()
}

fn found(name: &str) -> Response {
    match asset(name) {
        Some((mime, bytes)) => ([(header::CONTENT_TYPE, mime)], bytes.into_owned()).into_response(),
        None => (StatusCode::NOT_FOUND, "no such file\n").into_response(),
    }
}
