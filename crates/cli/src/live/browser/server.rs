//! The server of the page.

use std::io::Read as _;
use std::sync::Arc;
use std::thread;

use sextant_report::live_page;
use tiny_http::{Header, Method, Request, Response};

use super::super::pace::Pace;
use super::super::speed::Speed;
use super::documents::{Documents, Told};

/// A server of HTTP. It gives the page, the documents and how far the run is, to those who know the word in the address;
/// it serves nothing from the disk.
pub(super) struct Server {
    server: Arc<tiny_http::Server>,
    port: u16,
    folder: String,
}

impl Server {
    /// Listens at `address`, below `/TOKEN/`.
    pub(super) fn start(
        address: (&str, u16),
        token: &str,
        name: &str,
        documents: &Arc<Documents>,
        pace: &Arc<Pace>,
    ) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let server = Arc::new(tiny_http::Server::http(address)?);
        let port = server.server_addr().to_ip().map_or(address.1, |at| at.port());
        let folder = format!("/{token}/");
        let desk = Desk {
            folder: folder.clone(),
            page: live_page(name),
            documents: Arc::clone(documents),
            pace: Arc::clone(pace),
        };
        let listening = Arc::clone(&server);
        thread::Builder::new().name("live server".to_owned()).spawn(move || {
            for request in listening.incoming_requests() {
                desk.serve(request);
            }
        })?;
        Ok(Self { server, port, folder })
    }

    /// The port that it has.
    pub(super) fn port(&self) -> u16 {
        self.port
    }

    /// The folder of the page, with the word.
    pub(super) fn folder(&self) -> &str {
        &self.folder
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.server.unblock();
    }
}

/// What answers requests.
struct Desk {
    folder: String,
    page: String,
    documents: Arc<Documents>,
    pace: Arc<Pace>,
}

impl Desk {
    fn serve(&self, mut request: Request) {
        // Nothing that is asked here has a body.
        let _ = request.as_reader().take(1).read(&mut [0]);
        let what = request.url().strip_prefix(self.folder.as_str()).map(str::to_owned);
        let answer = what.and_then(|what| self.answer(request.method(), &what));
        // A browser that has gone needs no answer.
        let _ = match answer {
            Some((kind, text)) => request.respond(response(text, kind)),
            None => request.respond(response("there is no such page".to_owned(), "text/plain").with_status_code(404)),
        };
    }

    /// Media type and text of the answer, if there is one.
    fn answer(&self, method: &Method, what: &str) -> Option<(&'static str, String)> {
        match (method, what) {
            (Method::Get, "") => return Some(("text/html", self.page.clone())),
            (Method::Get, "document") => return Some(("application/json", self.documents.take().to_string())),
            (Method::Get, "state") => {}
            (Method::Post, "pause") => drop(self.pace.pause()),
            (Method::Post, "resume") => drop(self.pace.resume()),
            (Method::Post, "step") => drop(self.pace.step()),
            (Method::Post, what) => drop(self.pace.set_speed(Speed::read(what.strip_prefix("speed/")?).ok()?.0)),
            _ => return None,
        }
        Some(("application/json", self.state()))
    }

    /// How far the run is, and which document is the last one.
    fn state(&self) -> String {
        let Told { number, problem, is_last } = self.documents.ask();
        let progress = self.pace.progress();
        let state = serde_json::json!({
            "document": number,
            "problem": problem,
            "is_over": is_last,
            "is_paused": progress.is_paused,
            "speed": progress.speed,
            "time_s": progress.time.as_secs_f64(),
        });
        state.to_string()
    }
}

fn response(text: String, kind: &str) -> Response<std::io::Cursor<Vec<u8>>> {
    let headers = [
        ("Content-Type", format!("{kind}; charset=utf-8")),
        ("Cache-Control", "no-store".to_owned()),
        ("Referrer-Policy", "no-referrer".to_owned()),
        ("X-Content-Type-Options", "nosniff".to_owned()),
    ];
    headers.into_iter().fold(Response::from_string(text), |response, (name, value)| {
        let header = Header::from_bytes(name, value).expect("it is a header");
        response.with_header(header)
    })
}
