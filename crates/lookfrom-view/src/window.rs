//! A window of the page: its socket, and the thread that renders for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket};
use futures_util::{SinkExt, StreamExt};
use tokio::time::timeout;

use crate::document::Document;
use crate::mailbox::{Mailbox, Outgoing, Task};
use crate::message::{Answer, Request};
use crate::render;

/// Runs a window until its socket closes, and pings it at an interval. However it ends, its thread is told.
pub(crate) async fn run(socket: WebSocket, document: Arc<Document>, counted: Counted, ping: Duration) {
    let mailbox = Arc::new(Mailbox::default());
    let _closing = Closing(mailbox.clone());
    document.add(&mailbox);
    let thread = {
        let (mailbox, document) = (mailbox.clone(), document.clone());
        std::thread::Builder::new().name("window".to_owned()).spawn(move || {
            let _counted = counted;
            let _closing = Closing(mailbox.clone());
            render::run(mailbox, document);
        })
    };
    if thread.is_err() {
        return;
    }
    let (mut sink, mut stream) = socket.split();
    let sending = async {
        loop {
            let message = match timeout(ping, mailbox.next()).await {
                Ok(Some(Outgoing::Text(text))) => Message::Text(text.into()),
                Ok(Some(Outgoing::Binary(bytes))) => Message::Binary(bytes.into()),
                Ok(None) => return,
                Err(_) => Message::Ping(Bytes::new()),
            };
            if sink.send(message).await.is_err() {
                return;
            }
        }
    };
    let receiving = async {
        while let Some(Ok(message)) = stream.next().await {
            match message {
                Message::Text(text) => match Request::of_text(&text) {
                    Ok(request) => mailbox.put(Task::Request(request)),
                    Err(answer) => mailbox.say(&answer),
                },
                Message::Binary(_) => {
                    let message = "a binary message; expected a text".to_owned();
                    mailbox.say(&Answer::refusal(None, message));
                }
                Message::Close(_) => return,
                Message::Ping(_) | Message::Pong(_) => {}
            }
        }
    };
    tokio::select! {
        () = sending => {}
        () = receiving => {}
    }
}

/// Closes a mailbox when dropped.
struct Closing(Arc<Mailbox>);

impl Drop for Closing {
    fn drop(&mut self) {
        self.0.close();
    }
}

/// Counts as a window until it is dropped.
pub(crate) struct Counted(Arc<AtomicUsize>);

impl Counted {
    /// One more window, unless there are so many.
    pub(crate) fn new(count: &Arc<AtomicUsize>, most: usize) -> Option<Self> {
        let more = |windows| (windows < most).then_some(windows + 1);
        count.fetch_update(Ordering::AcqRel, Ordering::Acquire, more).ok()?;
        Some(Self(count.clone()))
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::AcqRel);
    }
}
