//! Running process with its three pipes.
//!
//! Threads move the bytes, so that every wait has a deadline and a process may answer before it has read everything.

use std::io::{BufRead as _, BufReader, Read, Write as _};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::failure::ProcessFault;
use super::protocol::{self, FRAME_ANSWER_BYTES, FrameMessage, MAGIC, OPENING_ANSWER_BYTES};
use super::spec::ProcessSpec;
use crate::image::{Image, Rgba8};
use crate::text;

/// Maximum size of a chunk that is read at once, in bytes: the capacity of a pipe on Linux.
const CHUNK_BYTES: usize = 1 << 16;

/// Maximum number of chunks that wait for the receiver. A process that writes without end is blocked after these.
const WAITING_CHUNKS: usize = 16;

/// Maximum length of a line of standard error that is read, in bytes.
const LINE_BYTES: u64 = 1 << 12;

/// Time for which a process that closed its standard output may run on before it is stopped.
const END_WAIT: Duration = Duration::from_millis(300);

/// Time limits of a process.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeLimits {
    /// Limit for the answer to the opening message.
    pub(super) start: Duration,
    /// Limit for the answer to a frame.
    pub(super) frame: Duration,
}

/// Running process that has answered the opening message. Dropping it stops the process.
#[derive(Debug)]
pub(super) struct Connection {
    process: Stopped,
    to_process: Sender<Vec<u8>>,
    /// Times at which messages were written completely.
    written: Receiver<Instant>,
    from_process: Receiver<Vec<u8>>,
    /// Bytes that were received, but not read yet.
    pending: Vec<u8>,
    last_line: Arc<Mutex<String>>,
    /// Number of frames that were sent.
    frames: u32,
}

/// Process that is stopped when it is dropped.
#[derive(Debug)]
struct Stopped(Child);

impl Drop for Stopped {
    fn drop(&mut self) {
        // Fails only if the process has ended.
        drop(self.0.kill());
        drop(self.0.wait());
    }
}

impl Connection {
    /// Starts the process and exchanges opening messages with it.
    pub(super) fn start(spec: &ProcessSpec, limits: TimeLimits) -> Result<Self, ProcessFault> {
        let begun = Instant::now();
        let (program, arguments) = spec.command.split_first().ok_or(ProcessFault::Start("no command".to_owned()))?;
        let mut command = Command::new(program);
        // Ctrl+C in a terminal then interrupts only this program, which still writes its results so far. The process
        // ends when its standard input ends.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| ProcessFault::Start(text::message(&error.to_string())))?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let process = Stopped(child);
        let (Some(stdin), Some(stdout), Some(stderr)) = pipes else {
            return Err(ProcessFault::Start("it has no pipes".to_owned()));
        };
        let (to_process, messages) = channel();
        let (written_at, written) = channel();
        let (chunks, from_process) = sync_channel(WAITING_CHUNKS);
        let last_line = Arc::default();
        let keep = Arc::clone(&last_line);
        thread::spawn(move || write_all(stdin, &messages, &written_at));
        thread::spawn(move || read_all(stdout, &chunks));
        thread::spawn(move || keep_last_line(stderr, &keep));
        let mut connection =
            Self { process, to_process, written, from_process, pending: Vec::new(), last_line, frames: 0 };
        connection.send(protocol::opening(spec.format, spec.depth));
        let deadline = Deadline { at: begun + limits.start, limit: limits.start };
        match connection.receive(OPENING_ANSWER_BYTES, "the opening answer", deadline) {
            Ok(answer) => protocol::check_opening_answer(&answer)?,
            // Short garbage, such as a greeting, is reported as such.
            Err(fault) if MAGIC.starts_with(&connection.pending) => return Err(fault),
            Err(_) => protocol::check_opening_answer(&connection.pending)?,
        }
        connection.written.try_iter().for_each(drop);
        Ok(connection)
    }

    /// Lets the process upscale a frame into `full`. Returns the time of the transfer: all time except that between the
    /// end of the message and the first bytes of the answer.
    pub(super) fn upscale(
        &mut self,
        spec: &ProcessSpec,
        frame: FrameMessage<'_>,
        full: &mut Image<Rgba8>,
        limit: Duration,
    ) -> Result<Duration, ProcessFault> {
        let begun = Instant::now();
        let deadline = Deadline { at: begun + limit, limit };
        let frame = FrameMessage { number: self.frames, ..frame };
        self.frames = self.frames.wrapping_add(1);
        self.send(frame.encode(spec.format));
        let header = self.receive(FRAME_ANSWER_BYTES, "the header of the picture", deadline)?;
        let answered = Instant::now();
        // A process that answers before it has read everything takes no time of its own in this measure.
        let sent = self.written.try_iter().last().unwrap_or(answered);
        protocol::check_frame_answer(&header, &frame)?;
        let bytes = full.pixels().len() * spec.format.pixel_bytes();
        let pixels = self.receive(bytes, "the picture", deadline)?;
        protocol::decode(&pixels, spec.format, full)?;
        Ok(begun.elapsed().saturating_sub(answered.saturating_duration_since(sent)))
    }

    /// Queues a message. If the process has closed its standard input, waiting for the answer finds the reason.
    fn send(&self, message: Vec<u8>) {
        drop(self.to_process.send(message));
    }

    /// Returns the next `count` bytes of standard output. `awaited` names them in messages.
    fn receive(&mut self, count: usize, awaited: &'static str, deadline: Deadline) -> Result<Vec<u8>, ProcessFault> {
        while self.pending.len() < count {
            match self.from_process.recv_timeout(deadline.at.saturating_duration_since(Instant::now())) {
                Ok(chunk) => self.pending.extend(chunk),
                Err(RecvTimeoutError::Timeout) => {
                    let (limit, received) = (deadline.limit, self.pending.len());
                    return Err(ProcessFault::TooSlow { limit, awaited, received, expected: count });
                }
                Err(RecvTimeoutError::Disconnected) => return Err(self.ended()),
            }
        }
        let rest = self.pending.split_off(count);
        Ok(std::mem::replace(&mut self.pending, rest))
    }

    /// Returns the fault of a process that closed its standard output.
    fn ended(&mut self) -> ProcessFault {
        let until = Instant::now() + END_WAIT;
        let status = loop {
            match self.process.0.try_wait() {
                Ok(Some(status)) => break words_of(status),
                Ok(None) if Instant::now() < until => thread::sleep(Duration::from_millis(5)),
                Ok(None) | Err(_) => break "a closed standard output, although it was still running".to_owned(),
            }
        };
        // The last line may still be on its way.
        while Arc::strong_count(&self.last_line) > 1 && Instant::now() < until {
            thread::sleep(Duration::from_millis(5));
        }
        let stderr = self.last_line.lock().unwrap_or_else(PoisonError::into_inner).clone();
        ProcessFault::Ended { status, stderr }
    }
}

/// Point in time at which waiting ends, and the time limit that it results from.
#[derive(Clone, Copy, Debug)]
struct Deadline {
    at: Instant,
    limit: Duration,
}

/// Describes how a process ended: its exit code or the signal.
fn words_of(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("signal {signal}");
    }
    status.code().map_or_else(|| status.to_string(), |code| format!("exit code {code}"))
}

/// Writes messages to the process until it closes its standard input, and reports when each is written.
fn write_all(mut stdin: ChildStdin, messages: &Receiver<Vec<u8>>, written: &Sender<Instant>) {
    for message in messages {
        let done = stdin.write_all(&message).and_then(|()| stdin.flush()).is_ok();
        if !done || written.send(Instant::now()).is_err() {
            return;
        }
    }
}

/// Sends the standard output of the process in chunks until it ends.
fn read_all(mut stdout: ChildStdout, chunks: &SyncSender<Vec<u8>>) {
    loop {
        let mut chunk = vec![0; CHUNK_BYTES];
        match stdout.read(&mut chunk) {
            Ok(0) | Err(_) => return,
            Ok(count) => chunk.truncate(count),
        }
        if chunks.send(chunk).is_err() {
            return;
        }
    }
}

/// Reads standard error until it ends, and keeps its last line that is not blank.
fn keep_last_line(stderr: ChildStderr, last: &Mutex<String>) {
    let mut stderr = BufReader::new(stderr);
    loop {
        let mut line = Vec::new();
        match stderr.by_ref().take(LINE_BYTES).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let line = text::message(&String::from_utf8_lossy(&line));
        if !line.is_empty() {
            *last.lock().unwrap_or_else(PoisonError::into_inner) = line;
        }
    }
}
