//! The server as a browser, a foreign page and a clumsy program meet it.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use page::{ServeError, Server, Source, Token, serve, serve_others};

/// A source that counts what it is asked.
#[derive(Default)]
struct Counted {
    halts: AtomicUsize,
    resets: AtomicUsize,
    refusal: Mutex<Option<String>>,
}

impl Source for Counted {
    fn plan(&self) -> String {
        "{\"creature\":\"allen\"}".to_owned()
    }

    fn state(&self) -> String {
        "{\"time_s\":1.5}".to_owned()
    }

    fn timeline(&self, after: u64) -> String {
        format!("{{\"changes\":{after}}}")
    }

    fn halt(&self) {
        self.halts.fetch_add(1, Ordering::SeqCst);
    }

    fn reset(&self) -> Result<(), String> {
        self.resets.fetch_add(1, Ordering::SeqCst);
        self.refusal
            .lock()
            .expect("no test panics with it")
            .clone()
            .map_or(Ok(()), Err)
    }
}

fn any_port() -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], 0))
}

fn start() -> (Server, Arc<Counted>) {
    let source = Arc::new(Counted::default());
    let server = serve(any_port(), source.clone()).expect("a free port");
    (server, source)
}

/// Sends `bytes` and reads the whole answer.
fn talk(server: &Server, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(server.address()).expect("the server listens");
    stream
        .set_read_timeout(Some(Duration::from_secs(10)))
        .expect("a timeout");
    stream.write_all(bytes).expect("the server reads");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("an answer in full");
    answer
}

fn ask(server: &Server, method: &str, path: &str, more: &str) -> String {
    let request = format!(
        "{method} {path} HTTP/1.1\r\nHost: {}\r\n{more}\r\n",
        server.address()
    );
    talk(server, request.as_bytes())
}

fn status(answer: &str) -> &str {
    answer.split(' ').nth(1).unwrap_or_default()
}

fn body(answer: &str) -> &str {
    answer.split_once("\r\n\r\n").map_or("", |(_, body)| body)
}

#[test]
fn the_page_and_all_it_refers_to_is_served() {
    let (server, _) = start();
    let index = ask(&server, "GET", "/", "");
    assert_eq!(status(&index), "200");
    assert!(index.contains("Content-Type: text/html"));
    assert!(index.contains("frame-ancestors 'none'"));
    let mut waiting: Vec<String> = referred(body(&index), &["src=\"", "href=\""]);
    let mut seen = Vec::new();
    while let Some(path) = waiting.pop() {
        if seen.contains(&path) {
            continue;
        }
        let answer = ask(&server, "GET", &path, "");
        assert_eq!(status(&answer), "200", "{path}");
        waiting.extend(referred(body(&answer), &["from \"."]));
        seen.push(path);
    }
    assert!(seen.len() >= 16, "scripts import each other: {seen:?}");
}

/// Paths that follow one of `marks` in `text`, up to the closing quote.
fn referred(text: &str, marks: &[&str]) -> Vec<String> {
    let after = marks.iter().flat_map(|mark| text.split(mark).skip(1));
    let paths = after.filter_map(|rest| rest.split('"').next());
    paths
        .filter(|path| path.starts_with('/'))
        .map(str::to_owned)
        .collect()
}

#[test]
fn nothing_is_loaded_from_elsewhere() {
    let (server, _) = start();
    for path in ["/", "/style.css", "/main.js", "/wiring.js"] {
        let answer = ask(&server, "GET", path, "");
        let text = body(&answer).replace("http://www.w3.org/", "");
        assert!(!text.contains("http:") && !text.contains("https:"), "{path}");
    }
}

#[test]
fn plan_and_state_pass_through_unread() {
    let (server, _) = start();
    let plan = ask(&server, "GET", "/api/plan", "");
    assert!(plan.contains("Content-Type: application/json"));
    assert_eq!(body(&plan), "{\"creature\":\"allen\"}");
    assert_eq!(
        body(&ask(&server, "GET", "/api/state?now", "")),
        "{\"time_s\":1.5}"
    );
}

#[test]
fn the_time_line_is_asked_for_what_is_new() {
    let (server, _) = start();
    assert_eq!(body(&ask(&server, "GET", "/api/timeline", "")), "{\"changes\":0}");
    assert_eq!(
        body(&ask(&server, "GET", "/api/timeline?after=17", "")),
        "{\"changes\":17}"
    );
    assert_eq!(status(&ask(&server, "GET", "/api/timeline?after=x", "")), "400");
    assert_eq!(status(&ask(&server, "POST", "/api/timeline", "")), "405");
}

#[test]
fn others_press_no_button_without_the_token() {
    let source = Arc::new(Counted::default());
    let token = Token::new("0123456789abcdef").expect("long enough");
    let everywhere = SocketAddr::from(([0, 0, 0, 0], 0));
    let server = serve_others(everywhere, token, source.clone()).expect("a free port");
    let door = SocketAddr::from(([127, 0, 0, 1], server.address().port()));
    // To this machine by the name that another would use: as good as from elsewhere.
    let press = |more: &str| {
        let mut stream = TcpStream::connect(door).expect("the server listens");
        let request = format!("POST /api/halt HTTP/1.1\r\nHost: robot.example\r\n{more}\r\n");
        stream.write_all(request.as_bytes()).expect("the server reads");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer in full");
        status(&answer).to_owned()
    };
    assert_eq!(press(""), "401");
    assert_eq!(press("Authorization: Bearer 0123456789abcdeF\r\n"), "401");
    assert_eq!(source.halts.load(Ordering::SeqCst), 0);
    assert_eq!(press("Authorization: Bearer 0123456789abcdef\r\n"), "200");
    assert_eq!(source.halts.load(Ordering::SeqCst), 1);
    server.stop();
    assert_eq!(Arc::strong_count(&source), 1);
}

#[test]
fn the_buttons_lead_to_the_source() {
    let (server, source) = start();
    assert_eq!(
        status(&ask(&server, "POST", "/api/halt", "Content-Length: 0\r\n")),
        "200"
    );
    assert_eq!(source.halts.load(Ordering::SeqCst), 1);
    assert_eq!(status(&ask(&server, "POST", "/api/reset", "")), "200");
    *source.refusal.lock().expect("no test panics with it") = Some("the \"bumper\" is pressed".into());
    let refused = ask(&server, "POST", "/api/reset", "");
    assert_eq!(status(&refused), "409");
    assert_eq!(body(&refused), "{\"error\":\"the \\\"bumper\\\" is pressed\"}");
    assert_eq!(source.resets.load(Ordering::SeqCst), 2);
}

#[test]
fn wrong_methods_and_paths_do_nothing() {
    let (server, source) = start();
    assert_eq!(status(&ask(&server, "GET", "/api/halt", "")), "405");
    assert_eq!(status(&ask(&server, "POST", "/api/state", "")), "405");
    assert_eq!(status(&ask(&server, "GET", "/../Cargo.toml", "")), "404");
    assert_eq!(status(&ask(&server, "DELETE", "/", "")), "405");
    assert_eq!(source.halts.load(Ordering::SeqCst), 0);
}

#[test]
fn a_foreign_page_is_refused() {
    let (server, source) = start();
    let rebound = "GET /api/state HTTP/1.1\r\nHost: evil.example:80\r\n\r\n";
    assert_eq!(status(&talk(&server, rebound.as_bytes())), "403");
    let nameless = "POST /api/halt HTTP/1.1\r\n\r\n";
    assert_eq!(status(&talk(&server, nameless.as_bytes())), "403");
    let forged = ask(&server, "POST", "/api/reset", "Origin: http://evil.example\r\n");
    assert_eq!(status(&forged), "403");
    let two_hosts = ask(&server, "POST", "/api/reset", "Host: evil.example\r\n");
    assert_eq!(status(&two_hosts), "400");
    assert_eq!(
        source.halts.load(Ordering::SeqCst) + source.resets.load(Ordering::SeqCst),
        0
    );
    let own = format!("Origin: http://{}\r\n", server.address());
    assert_eq!(status(&ask(&server, "POST", "/api/reset", &own)), "200");
}

#[test]
fn oversized_requests_are_refused() {
    let (server, source) = start();
    let long = format!("X-Long: {}\r\n", "a".repeat(20_000));
    assert_eq!(status(&ask(&server, "GET", "/", &long)), "431");
    let many = "X: y\r\n".repeat(100);
    assert_eq!(status(&ask(&server, "GET", "/", &many)), "431");
    for length in ["1025", "18446744073709551616"] {
        let more = format!("Content-Length: {length}\r\n");
        assert_eq!(status(&ask(&server, "POST", "/api/halt", &more)), "413");
    }
    assert_eq!(source.halts.load(Ordering::SeqCst), 0);
}

#[test]
fn nonsense_is_answered_or_dropped() {
    let (server, _) = start();
    assert_eq!(
        status(&talk(&server, b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n")),
        "400"
    );
    assert_eq!(
        status(&talk(&server, b"GET / HTTP/1.1\r\nHost: \xff\xfe\r\n\r\n")),
        "403"
    );
    assert_eq!(
        status(&ask(&server, "POST", "/api/halt", "Content-Length: -1\r\n")),
        "400"
    );
    assert_eq!(
        status(&ask(
            &server,
            "POST",
            "/api/halt",
            "Transfer-Encoding: chunked\r\n"
        )),
        "400"
    );
    assert_eq!(talk(&server, b"GET / HTT"), "", "an unfinished request times out");
    assert_eq!(status(&ask(&server, "GET", "/", "")), "200");
}

#[test]
fn silent_connections_do_not_hold_the_page_for_long() {
    let (server, _) = start();
    let silent: Vec<TcpStream> = (0..12)
        .map(|_| TcpStream::connect(server.address()).expect("the server listens"))
        .collect();
    assert_eq!(status(&ask(&server, "GET", "/api/state", "")), "200");
    drop(silent);
}

#[test]
fn a_taken_port_says_what_to_change() {
    let holder = TcpListener::bind(any_port()).expect("a free port");
    let taken = holder.local_addr().expect("bound");
    let refused = serve(taken, Arc::new(Counted::default())).expect_err("it is taken");
    assert!(matches!(refused, ServeError::PortTaken { address } if address == taken));
    let text = refused.to_string();
    assert!(text.contains(&format!("port {}", taken.port())), "{text}");
    assert!(
        text.contains("--page-port N") && text.contains("0 takes any free one"),
        "{text}"
    );
}

#[test]
fn only_loopback_is_served() {
    let outside = SocketAddr::from(([0, 0, 0, 0], 0));
    let refused = serve(outside, Arc::new(Counted::default())).expect_err("reachable from outside");
    assert!(matches!(refused, ServeError::NotLoopback { .. }));
}

#[test]
fn stopping_joins_every_thread_and_frees_the_port() {
    let (server, source) = start();
    let address = server.address();
    let idle = TcpStream::connect(address).expect("the server listens");
    server.stop();
    assert_eq!(
        Arc::strong_count(&source),
        1,
        "no thread holds the source any longer"
    );
    drop(idle);
    let again = serve(address, source.clone()).expect("the port is free again");
    drop(again);
    assert_eq!(Arc::strong_count(&source), 1);
}
