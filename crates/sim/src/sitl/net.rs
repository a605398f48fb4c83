//! Sockets to ground stations: packets by UDP, streams by TCP. Nothing here waits.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::time::{Duration, Instant};

/// Ground stations that speak by UDP beside the one that is spoken to first.
const PEERS: usize = 8;

/// A ground station that has been silent for so long is not spoken to any more.
const PATIENCE: Duration = Duration::from_secs(30);

/// Ground stations that are connected by TCP, at most.
pub const STREAMS: usize = 4;

/// Links in all: one for all packets, one for each stream.
pub const LINKS: usize = 1 + STREAMS;

/// Packets that are taken at once: no more commands than a link answers before it is asked what to
/// send, and a flood does not keep the vehicle from flying.
const PACKETS: usize = 4;

/// Bytes of a stream that are taken at once: some five commands.
const BYTES: usize = 256;

/// Bytes that wait for a stream that does not take them; more are lost, frame by frame.
const BACKLOG: usize = 65_536;

/// What has come.
pub enum Arrival<'a> {
    /// A packet, by the link of that number.
    Packet(usize, &'a [u8]),
    /// Bytes, by the link of that number.
    Bytes(usize, &'a [u8]),
    /// Somebody new is at the other end of that link.
    Opened(usize, SocketAddr),
    /// Nobody is any more.
    Closed(usize),
}

struct Stream {
    socket: TcpStream,
    waiting: Vec<u8>,
}

/// The sockets.
pub struct Net {
    /// A socket, and whom it speaks to first.
    udp: Option<(UdpSocket, SocketAddr)>,
    peers: Vec<(SocketAddr, Instant)>,
    listener: Option<TcpListener>,
    streams: [Option<Stream>; STREAMS],
    /// Frames that a stream did not take.
    pub lost: u64,
}

impl Net {
    /// Speaks to `udp` first by UDP, and listens at `tcp`. The error is one line.
    pub fn open(udp: Option<SocketAddr>, tcp: Option<SocketAddr>) -> Result<Self, String> {
        let udp = match udp {
            Some(target) => Some((Self::socket(target)?, target)),
            None => None,
        };
        let listener = tcp
            .map(|address| {
                TcpListener::bind(address)
                    .and_then(|listener| listener.set_nonblocking(true).map(|()| listener))
                    .map_err(|e| format!("--tcp {address}: {e}; choose another port, or 0 for none"))
            })
            .transpose()?;
        Ok(Self {
            udp,
            peers: Vec::new(),
            listener,
            streams: [const { None }; STREAMS],
            lost: 0,
        })
    }

    /// A socket that reaches `target`.
    fn socket(target: SocketAddr) -> Result<UdpSocket, String> {
        // From the loopback to itself, and only then from everywhere.
        let own: SocketAddr = match (target.ip().is_loopback(), target.is_ipv4()) {
            (true, true) => ([127, 0, 0, 1], 0).into(),
            (false, true) => ([0, 0, 0, 0], 0).into(),
            (true, false) => (std::net::Ipv6Addr::LOCALHOST, 0).into(),
            (false, false) => (std::net::Ipv6Addr::UNSPECIFIED, 0).into(),
        };
        UdpSocket::bind(own)
            .and_then(|socket| socket.set_nonblocking(true).map(|()| socket))
            .map_err(|e| format!("--udp {target}: {e}"))
    }

    /// Hands over what has come, some of it; what is left waits in its socket, where nothing is lost.
    pub fn receive(&mut self, take: &mut dyn FnMut(Arrival<'_>)) {
        self.receive_packets(take);
        self.accept(take);
        for index in 0..STREAMS {
            self.receive_bytes(index, take);
        }
    }

    fn receive_packets(&mut self, take: &mut dyn FnMut(Arrival<'_>)) {
        let mut buffer = [0; 2048];
        for _ in 0..PACKETS {
            let Some((socket, target)) = &self.udp else {
                return;
            };
            match socket.recv_from(&mut buffer) {
                Ok((length, from)) => {
                    if from != *target {
                        self.heard(from);
                    }
                    take(Arrival::Packet(0, &buffer[..length]));
                }
                // Nobody listens there yet.
                Err(e) if e.kind() == ErrorKind::ConnectionRefused => {}
                Err(_) => break,
            }
        }
    }

    fn heard(&mut self, from: SocketAddr) {
        let now = Instant::now();
        self.peers
            .retain(|(peer, last)| *peer != from && now - *last < PATIENCE);
        if self.peers.len() < PEERS {
            self.peers.push((from, now));
        }
    }

    fn accept(&mut self, take: &mut dyn FnMut(Arrival<'_>)) {
        let Some(listener) = &self.listener else {
            return;
        };
        while let Ok((socket, from)) = listener.accept() {
            // A stream too many is closed at once.
            let Some(index) = self.streams.iter().position(Option::is_none) else {
                continue;
            };
            if socket.set_nonblocking(true).is_ok() && socket.set_nodelay(true).is_ok() {
                self.streams[index] = Some(Stream {
                    socket,
                    waiting: Vec::new(),
                });
                take(Arrival::Opened(1 + index, from));
            }
        }
    }

    fn receive_bytes(&mut self, index: usize, take: &mut dyn FnMut(Arrival<'_>)) {
        let mut buffer = [0; BYTES];
        let Some(stream) = &mut self.streams[index] else {
            return;
        };
        match stream.socket.read(&mut buffer) {
            Ok(length) if length > 0 => take(Arrival::Bytes(1 + index, &buffer[..length])),
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            _ => {
                self.streams[index] = None;
                take(Arrival::Closed(1 + index));
            }
        }
    }

    /// Whether there is somebody at the other end of a link.
    pub fn is_open(&self, link: usize) -> bool {
        match link {
            0 => self.udp.is_some(),
            _ => self.streams.get(link - 1).is_some_and(Option::is_some),
        }
    }

    /// Sends a frame by a link.
    pub fn send(&mut self, link: usize, frame: &[u8]) {
        if link == 0 {
            let Some((socket, target)) = &self.udp else {
                return;
            };
            // What a network does not take is lost: links live with that.
            let _ = socket.send_to(frame, target);
            for (peer, _) in &self.peers {
                let _ = socket.send_to(frame, peer);
            }
        } else if let Some(Some(stream)) = self.streams.get_mut(link - 1) {
            if stream.waiting.len() + frame.len() > BACKLOG {
                self.lost += 1;
            } else {
                stream.waiting.extend_from_slice(frame);
            }
        }
    }

    /// Sends on what waits for streams.
    pub fn flush(&mut self) {
        for stream in self.streams.iter_mut().flatten() {
            while !stream.waiting.is_empty() {
                match stream.socket.write(&stream.waiting) {
                    Ok(length) if length > 0 => {
                        stream.waiting.drain(..length);
                    }
                    // A stream that is closed says so when it is read.
                    _ => break,
                }
            }
        }
    }
}
