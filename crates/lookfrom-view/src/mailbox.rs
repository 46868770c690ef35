//! Messages on the way between the page of a window and its thread. Only the latest counts: a request replaces an earlier
//! one of its type that has not been taken, a picture an earlier one that has not been sent.

use std::collections::VecDeque;
use std::mem::discriminant;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

#[cfg(feature = "server")]
use tokio::sync::Notify;

use crate::message::{Answer, Request};

/// The most texts that wait to be sent; a page that reads no faster is left.
const MOST_TEXTS: usize = 256;

/// Something for the thread of a window to do.
#[derive(Debug)]
pub(crate) enum Task {
    /// The scene was read again, or there is an error in it.
    SceneChanged,
    /// A message of the page.
    Request(Request),
}

/// A message for the page.
#[derive(Clone, Debug, PartialEq)]
pub enum Outgoing {
    /// An answer, in JSON.
    Text(String),
    /// A frame: the length of its header in four bytes, the header in JSON, and what belongs to it.
    Binary(Vec<u8>),
}

/// Both directions of a window.
#[derive(Debug, Default)]
pub(crate) struct Mailbox {
    inbox: Mutex<Vec<Task>>,
    arrived: Condvar,
    /// Whether there is a task, for a look without a lock.
    has_tasks: AtomicBool,
    closed: AtomicBool,
    outbox: Mutex<Outbox>,
    #[cfg(feature = "server")]
    ready: Notify,
}

#[derive(Debug, Default)]
struct Outbox {
    queue: VecDeque<Outgoing>,
    /// Sent after the queue is empty.
    picture: Option<Vec<u8>>,
}

impl Mailbox {
    /// Adds a task, in place of an untaken one of the same type.
    pub(crate) fn put(&self, task: Task) {
        let mut inbox = locked(&self.inbox);
        inbox.retain(|other| match (other, &task) {
            (Task::Request(other), Task::Request(new)) => discriminant(other) != discriminant(new),
            (other, new) => discriminant(other) != discriminant(new),
        });
        inbox.push(task);
        self.has_tasks.store(true, Ordering::Release);
        self.arrived.notify_one();
    }

    /// Takes all tasks; waits for one if `patient`. `None` once the window is closed.
    pub(crate) fn take(&self, patient: bool) -> Option<Vec<Task>> {
        let mut inbox = locked(&self.inbox);
        while patient && inbox.is_empty() && !self.is_closed() {
            inbox = self.arrived.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
        self.has_tasks.store(false, Ordering::Release);
        (!self.is_closed()).then(|| std::mem::take(&mut *inbox))
    }

    /// Whether there is a task to take.
    pub(crate) fn has_tasks(&self) -> bool {
        self.has_tasks.load(Ordering::Acquire)
    }

    /// Ends the window's thread.
    #[cfg(feature = "server")]
    pub(crate) fn close(&self) {
        let _inbox = locked(&self.inbox);
        self.closed.store(true, Ordering::Release);
        self.arrived.notify_all();
        self.ready.notify_one();
    }

    /// Whether the window is closed.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Acquire)
    }

    /// Sends a text.
    pub(crate) fn say(&self, answer: &Answer) {
        self.send(Outgoing::Text(answer.text()));
    }

    /// Sends a message after those before it.
    pub(crate) fn send(&self, message: Outgoing) {
        let mut outbox = locked(&self.outbox);
        if outbox.queue.len() < MOST_TEXTS {
            outbox.queue.push_back(message);
        }
        #[cfg(feature = "server")]
        self.ready.notify_one();
    }

    /// Sends a picture, in place of an unsent one.
    pub(crate) fn show(&self, frame: Vec<u8>) {
        locked(&self.outbox).picture = Some(frame);
        #[cfg(feature = "server")]
        self.ready.notify_one();
    }

    /// The next message to send, if there is one.
    pub(crate) fn outgoing(&self) -> Option<Outgoing> {
        let mut outbox = locked(&self.outbox);
        outbox.queue.pop_front().or_else(|| outbox.picture.take().map(Outgoing::Binary))
    }

    /// The next message to send; `None` once the window is closed.
    #[cfg(feature = "server")]
    pub(crate) async fn next(&self) -> Option<Outgoing> {
        loop {
            if self.is_closed() {
                return None;
            }
            let message = self.outgoing();
            if message.is_some() {
                return message;
            }
            self.ready.notified().await;
        }
    }
}

/// Locks a mutex, though a thread may have panicked while it held it.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
