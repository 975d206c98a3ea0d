//! The live page as an operator meets it: a real daemon, a real browser, real clicks. Skipped without Chromium.

mod browser;
mod scene;

use std::net::TcpListener;

use browser::Browser;
use scene::{Player, Scene, wait_for};

/// A daemon with its page, and the page's address.
fn daemon(stage: &Scene, name: &str) -> (Player, String) {
    let free = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
    let port = free.local_addr().expect("bound").port().to_string();
    drop(free);
    let arguments = ["--name", name, "--page-port", &port, "--seconds", "170"];
    let player = stage.start(env!("CARGO_BIN_EXE_subsumed"), &arguments);
    wait_for("the body is free", || stage.is_free(name));
    (player, format!("http://127.0.0.1:{port}/"))
}

#[test]
fn clicks_on_halt_and_reset_halt_and_free_the_body() {
    let stage = Scene::new("clicked");
    let Some(mut browser) = Browser::start(stage.run.join("browser")) else {
        return;
    };
    let (mut daemon, address) = daemon(&stage, "clicked");
    browser.size(1400, 900);
    browser.open(&address);
    browser.sees("document.body?.dataset.connected === 'true'");
    let emergency = || {
        stage
            .causes("clicked")
            .iter()
            .any(|cause| cause == "emergency stop")
    };
    assert!(!emergency());
    browser.click("#halt");
    wait_for("the daemon is halted", emergency);
    browser.sees("document.querySelector('#halt-state').dataset.halted === 'true'");
    browser.sees("document.querySelector('#halt-causes').textContent.includes('emergency stop')");
    browser.sees("document.querySelector('#events').textContent.includes('emergency stop from the page')");
    browser.click("#reset");
    wait_for("the daemon runs", || !emergency() && stage.is_free("clicked"));
    browser.sees("!document.querySelector('#halt-causes').textContent.includes('emergency stop')");
    // The time line tells it afterwards.
    browser.open(&format!("{address}api/timeline"));
    browser.sees(
        "JSON.parse(document.body.innerText).stretches.some((s) => \
         s.kind === 'halt' && s.name === 'emergency stop' && s.to_s > s.from_s)",
    );
    assert_eq!(browser.complaints, [""; 0]);
    assert!(daemon.leave().success());
}

#[test]
fn a_layer_shows_when_it_is_plugged_and_goes_when_it_is_killed() {
    let stage = Scene::new("plugged");
    let Some(mut browser) = Browser::start(stage.run.join("browser")) else {
        return;
    };
    let (mut daemon, address) = daemon(&stage, "plugged");
    browser.size(1400, 900);
    browser.open(&address);
    browser.sees("document.querySelector('#wiring [data-layer=avoid]')");
    let drawn = "document.querySelector('#wiring [data-layer=wander]')";
    assert!(browser.value(&format!("{drawn} === null")) == true);
    let mut wander = stage.wander("plugged");
    browser.sees(drawn);
    browser.sees("document.querySelector('#latency [data-latency=wander]')");
    browser.sees("document.querySelector('#timeline-lanes [data-lane=\"layer wander\"]')");
    browser.sees(
        "document.querySelector('#wiring .tap[data-holds=true] .constant')?.textContent.endsWith(' s')",
    );
    browser.sees(
        "[...document.querySelectorAll('#wiring .pulse')].some((pulse) => pulse.getAnimations().length > 0)",
    );
    let driven = "document.querySelector('#holders').textContent";
    browser.sees(&format!(
        "{driven}.includes('turn.heading hears avoid.heading of wander (level 1)')"
    ));
    let pid = wander.pid();
    wander.kill();
    browser.sees(&format!("{drawn} === null"));
    browser.sees(&format!("!{driven}.includes('wander')"));
    browser.sees("document.querySelector('#latency [data-latency=wander]') === null");
    let died = format!("layer wander (pid {pid}) died");
    browser.sees(&format!(
        "document.querySelector('#events').textContent.includes('{died}')"
    ));
    assert_eq!(browser.complaints, [""; 0]);
    assert!(daemon.leave().success());
}

/// Parts of the page that can be seen, by their views.
const SHOWN: &str = "[...document.querySelectorAll('main > section')].filter((s) => s.offsetHeight > 0).map((s) => s.dataset.view).join()";

/// What a thumb would miss: it is to be pressed, can be seen and is lower than 40 pixels.
const SMALL: &str = "[...document.querySelectorAll('button, input, #views a, #wires tbody a')].filter((b) => \
    b.offsetHeight > 0 && b.offsetHeight < 40).map((b) => b.id || b.textContent).join()";

/// How many pixels the page reaches beyond the window's right edge.
const BEYOND: &str = "Math.max(document.documentElement.scrollWidth, document.body.scrollWidth) - \
    document.documentElement.clientWidth";

#[test]
fn every_view_has_an_address_and_fits_a_phone() {
    let stage = Scene::new("viewed");
    let Some(mut browser) = Browser::start(stage.run.join("browser")) else {
        return;
    };
    let (mut daemon, address) = daemon(&stage, "viewed");
    browser.size(390, 844);
    let views = ["world", "wiring", "timeline", "latency", "wires", "events"];
    let one = views.map(|view| (view.to_string(), view));
    let wire = ("wires/sonar.map".to_string(), "wire");
    for (path, view) in one.into_iter().chain([wire]) {
        browser.open(&format!("{address}#/{path}"));
        browser.sees(&format!("document.body?.dataset.view === '{view}'"));
        browser.sees("document.body.dataset.connected === 'true'");
        assert_eq!(browser.value(SHOWN), view);
        browser.ask("Page.reload", &serde_json::json!({}));
        browser.sees("document.body?.dataset.connected === 'true'");
        assert_eq!(browser.value(SHOWN), view, "after a reload");
        assert_eq!(browser.value(SMALL), "", "{view}");
        assert_eq!(browser.value(BEYOND), 0, "{view} is wider than the phone");
    }
    browser.sees("document.querySelector('#wire-facts').textContent.includes('feelforce.map')");
    browser.value("history.back()");
    browser.sees("document.body.dataset.view === 'events'");
    browser.open(&format!("{address}#/"));
    browser.sees("document.body.dataset.view === 'all'");
    browser.click("#views a[data-view=timeline]");
    browser.sees("location.hash === '#/timeline' && document.body.dataset.view === 'timeline'");
    browser.open(&format!("{address}#/nothing"));
    browser.sees("!document.querySelector('#no-view').hidden && document.body.dataset.view === 'all'");
    assert_eq!(browser.value(BEYOND), 0, "all of it is wider than the phone");
    assert_eq!(browser.complaints, [""; 0]);
    assert!(daemon.leave().success());
}
