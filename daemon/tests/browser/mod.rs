//! A browser without a window, driven over its debugging pipe by DevTools messages.
//!
//! Must never wait for ever, nor leave a browser or its folder behind.

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver};

use serde_json::{Value, json};

use crate::scene::wait_for;

/// Names under which Chromium is installed.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// The pipe's two ends are file descriptors 3 and 4 by DevTools' rule; a shell makes them of what it is given.
const LAUNCH: &str = r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1"#;

/// A browser with one tab.
pub(crate) struct Browser {
    child: Child,
    told: ChildStdin,
    heard: Receiver<Value>,
    asked: u64,
    tab: String,
    folder: PathBuf,
    /// What scripts complained about.
    pub(crate) complaints: Vec<String>,
}

impl Browser {
    /// Starts one whose profile lies in `folder`; none, with a message, where there is no Chromium.
    pub(crate) fn start(folder: PathBuf) -> Option<Browser> {
        let places = std::env::var_os("PATH").unwrap_or_default();
        let mut programs = std::env::split_paths(&places).flat_map(|p| NAMES.map(|name| p.join(name)));
        let Some(program) = programs.find(|p| p.is_file()) else {
            eprintln!("skipped: the page in a browser (no chromium; `apt-get install chromium` grants it)");
            return None;
        };
        let mut child = Command::new("sh")
            .args(["-c", LAUNCH])
            .arg(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--no-first-run",
            ])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
            ])
            .args(["--disable-dev-shm-usage", "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", folder.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell starts");
        let told = child.stdin.take().expect("it was piped");
        let mut says = BufReader::new(child.stdout.take().expect("it was piped"));
        let (hears, heard) = mpsc::channel();
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            while says.read_until(0, &mut bytes).is_ok_and(|n| n > 0) {
                let message = serde_json::from_slice(bytes.strip_suffix(&[0]).unwrap_or(&bytes));
                if message.is_ok_and(|message| hears.send(message).is_err()) {
                    return;
                }
                bytes.clear();
            }
        });
        let (tab, complaints) = (String::new(), Vec::new());
        let mut browser = Browser {
            child,
            told,
            heard,
            asked: 0,
            tab,
            folder,
            complaints,
        };
        let made = browser.ask("Target.createTarget", &json!({"url": "about:blank"}));
        let joined = browser.ask(
            "Target.attachToTarget",
            &json!({"targetId": made["targetId"], "flatten": true}),
        );
        browser.tab = joined["sessionId"].as_str().expect("a tab has a session").into();
        browser.ask("Runtime.enable", &json!({}));
        browser.ask("Page.enable", &json!({}));
        Some(browser)
    }

    /// Sends a message and waits for its answer.
    pub(crate) fn ask(&mut self, method: &str, parameters: &Value) -> Value {
        self.asked += 1;
        let mut message = json!({"id": self.asked, "method": method, "params": parameters});
        if !self.tab.is_empty() {
            message["sessionId"] = json!(self.tab);
        }
        let text = format!("{message}\0");
        self.told.write_all(text.as_bytes()).expect("the browser listens");
        self.told.flush().expect("the browser listens");
        loop {
            let answer = self.heard.recv_timeout(stage::PATIENCE);
            let mut answer = answer.unwrap_or_else(|e| panic!("{method} was not answered: {e}"));
            if answer["id"] == self.asked {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].take();
            }
            let said = &answer["params"];
            let complains = answer["method"] == "Runtime.exceptionThrown"
                || answer["method"] == "Runtime.consoleAPICalled" && said["type"] == "error";
            if complains {
                self.complaints.push(said.to_string());
            }
        }
    }

    /// What a script's expression comes to.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let asked = json!({"expression": expression, "returnByValue": true});
        let mut answer = self.ask("Runtime.evaluate", &asked);
        let fault = &answer["exceptionDetails"];
        assert!(fault.is_null(), "{expression}: {fault}");
        answer["result"]["value"].take()
    }

    /// Waits until an expression is true.
    pub(crate) fn sees(&mut self, expression: &str) {
        wait_for(&format!("the page shows {expression}"), || {
            self.value(&format!("Boolean({expression})")) == true
        });
    }

    /// Opens an address.
    pub(crate) fn open(&mut self, address: &str) {
        self.ask("Page.navigate", &json!({"url": address}));
    }

    /// The window's size in pixels of the page.
    pub(crate) fn size(&mut self, width: u32, height: u32) {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.ask("Emulation.setDeviceMetricsOverride", &size);
    }

    /// Moves the pointer to the middle of an element, presses its button there and lets go.
    pub(crate) fn click(&mut self, selector: &str) {
        let place = self.value(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{block: 'center'}}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        ));
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            let (button, clicks) = if kind == "mouseMoved" {
                ("none", 0)
            } else {
                ("left", 1)
            };
            let event =
                json!({"type": kind, "x": place[0], "y": place[1], "button": button, "clickCount": clicks});
            self.ask("Input.dispatchMouseEvent", &event);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // By its process, not by a message: it may be what hangs. Its children leave with its pipes.
        let _ = self.child.kill();
        let _ = self.child.wait();
        for _ in 0..50 {
            if std::fs::remove_dir_all(&self.folder).is_ok() || !self.folder.exists() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
    }
}
