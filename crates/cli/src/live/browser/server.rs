//! The server of the page.

use std::io::Read as _;
use std::sync::Arc;
use std::thread;

use sextant_report::live_page;
use tiny_http::{Header, Method, Request, Response};

use super::super::pace::{Pace, Progress};
use super::super::speed::Speed;
use super::Place;
use super::documents::{Documents, Told};

/// A server of HTTP. It gives the page, the documents and how far the run is, to those who know the word in the address;
/// it serves nothing from the disk.
pub(super) struct Server {
    server: Arc<tiny_http::Server>,
    port: u16,
    folder: String,
}

impl Server {
    /// Listens at a place, below `/TOKEN/`.
    pub(super) fn start(
        place: Place<'_>,
        token: &str,
        documents: &Arc<Documents>,
        pace: Option<Arc<Pace>>,
    ) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let server = Arc::new(tiny_http::Server::http((place.host, place.port))?);
        let port = server.server_addr().to_ip().map_or(place.port, |at| at.port());
        let folder = format!("/{token}/");
        let desk =
            Desk { folder: folder.clone(), page: live_page(place.title), documents: Arc::clone(documents), pace };
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
    /// How fast it goes, where that can be changed.
    pace: Option<Arc<Pace>>,
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
            (Method::Post, what) => self.change(self.pace.as_ref()?, what)?,
            _ => return None,
        }
        Some(("application/json", self.state()))
    }

    /// Does what the page says; `None` if that is nothing.
    fn change(&self, pace: &Pace, what: &str) -> Option<()> {
        match what {
            "pause" => pace.pause(),
            "resume" => pace.resume(),
            "step" => pace.step(),
            _ => pace.set_speed(Speed::read(what.strip_prefix("speed/")?).ok()?.0),
        };
        Some(())
    }

    /// How far the run is, and which document is the last one.
    fn state(&self) -> String {
        let Told { number, news, is_last } = self.documents.ask();
        let pace = self.pace.as_ref().map(|pace| {
            let Progress { is_paused, speed, time } = pace.progress();
            serde_json::json!({ "is_paused": is_paused, "speed": speed, "time_s": time.as_secs_f64() })
        });
        serde_json::json!({ "document": number, "news": news, "is_over": is_last, "pace": pace }).to_string()
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
