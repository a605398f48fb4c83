//! The page around the plots.

use std::fmt::Write;
use std::iter::once;

use plotly::Plot;

use super::plots::{self, Drawing};
use super::{PhotoMark, Report};

/// Nothing is loaded from anywhere; the drawing library compiles its shaders (`unsafe-eval`).
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; \
                      style-src 'unsafe-inline'; img-src data: blob:";

/// The most events that are listed.
const MOST_EVENTS: usize = 100;

/// The report as one HTML file.
pub fn html(report: &Report) -> String {
    let drawings = Drawings::new(report);
    let mut page = String::new();
    head(&mut page, report);
    figures(&mut page, report);
    conditions(&mut page, report);
    drawings.show_path(&mut page);
    photos(&mut page, &report.photos);
    events(&mut page, report);
    drawings.show_over_time(&mut page);
    let version = env!("CARGO_PKG_VERSION");
    page.push_str(&format!(
        "<footer>Written by windhover {version}. Nothing in this file is loaded from a network.</footer>\n</main>\n"
    ));
    drawings.scripts(&mut page);
    page.push_str("</body>\n</html>\n");
    page
}

/// The plots; none where nothing was recorded.
struct Drawings {
    path: Vec<Drawing>,
    over_time: Vec<Drawing>,
}

impl Drawings {
    fn new(report: &Report) -> Self {
        if report.samples.is_empty() {
            return Self {
                path: Vec::new(),
                over_time: Vec::new(),
            };
        }
        Self {
            path: vec![plots::in_space(report), plots::from_above(report)],
            over_time: plots::over_time(report),
        }
    }

    fn show_path(&self, page: &mut String) {
        page.push_str("<section>\n<h2>Path</h2>\n");
        if self.path.is_empty() {
            page.push_str("<p class=\"note\">Nothing of the flight was recorded.</p>\n");
        } else {
            page.push_str("<div class=\"pair\">\n");
            self.path.iter().for_each(|drawing| figure(page, drawing));
            page.push_str("</div>\n");
        }
        page.push_str("</section>\n");
    }

    fn show_over_time(&self, page: &mut String) {
        if self.over_time.is_empty() {
            return;
        }
        page.push_str(
            "<p class=\"note zoom\">The plots over time zoom together: drag across one to zoom in, double-click to \
             see all again.</p>\n",
        );
        for drawing in &self.over_time {
            let title = drawing.title;
            add(page, format_args!("<section>\n<h2>{title}</h2>\n"));
            figure(page, drawing);
            page.push_str("</section>\n");
        }
    }

    /// The data of each plot, the library and what draws them.
    fn scripts(&self, page: &mut String) {
        let mut any = false;
        for drawing in self.path.iter().chain(&self.over_time) {
            // As part of a page `</script>` must not occur in it.
            let data = drawing.plot.to_json().replace('<', "\\u003c");
            let id = drawing.id;
            add(
                page,
                format_args!("<script type=\"application/json\" id=\"data-{id}\">{data}</script>\n"),
            );
            any = true;
        }
        if any {
            page.push_str(library(&Plot::offline_js_sources()));
            add(
                page,
                format_args!("\n<script>\n{}</script>\n", include_str!("page.js")),
            );
        }
    }
}

/// The drawing library of what the crate embeds; the formula typesetter after it is left out.
fn library(sources: &str) -> &str {
    const END: &str = "</script>";
    sources
        .find(END)
        .map_or(sources, |end| &sources[..end + END.len()])
}

fn head(page: &mut String, report: &Report) {
    let title = escape(&report.title);
    add(
        page,
        format_args!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n<header>\n\
             <h1>{title}</h1>\n",
            include_str!("page.css")
        ),
    );
    if !report.subtitle.is_empty() {
        let subtitle = escape(&report.subtitle);
        add(page, format_args!("<p class=\"subtitle\">{subtitle}</p>\n"));
    }
    page.push_str("</header>\n<noscript><p class=\"note\">The plots need JavaScript.</p></noscript>\n");
}

fn figures(page: &mut String, report: &Report) {
    if report.figures.is_empty() {
        return;
    }
    page.push_str("<dl class=\"figures\">\n");
    for figure in &report.figures {
        // Hashes and lists are no headline.
        let long = figure.value.chars().count() > 12;
        add(
            page,
            format_args!(
                "<div><dt>{}</dt><dd{}>{}",
                escape(&figure.label),
                if long { " class=\"long\"" } else { "" },
                escape(&figure.value)
            ),
        );
        if !figure.unit.is_empty() {
            let unit = escape(&figure.unit);
            add(page, format_args!(" <span class=\"unit\">{unit}</span>"));
        }
        page.push_str("</dd></div>\n");
    }
    page.push_str("</dl>\n");
}

fn conditions(page: &mut String, report: &Report) {
    if report.conditions.is_empty() {
        return;
    }
    page.push_str("<section>\n<h2>Conditions</h2>\n<dl class=\"conditions\">\n");
    for (name, value) in &report.conditions {
        let (name, value) = (escape(name), escape(value));
        add(page, format_args!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"));
    }
    page.push_str("</dl>\n</section>\n");
}

fn figure(page: &mut String, drawing: &Drawing) {
    let Drawing { id, height, .. } = drawing;
    let alt = escape(drawing.alt);
    let over_time = if drawing.over_time { " data-over-time" } else { "" };
    add(
        page,
        format_args!(
            "<figure>\n<div class=\"plot\" id=\"{id}\" role=\"img\" aria-label=\"{alt}\" \
             style=\"height:{height}px\"{over_time}></div>\n<figcaption>{alt}.</figcaption>\n</figure>\n"
        ),
    );
}

fn photos(page: &mut String, photos: &[PhotoMark]) {
    page.push_str("<section>\n<h2>Photo stops</h2>\n");
    if photos.is_empty() {
        page.push_str("<p class=\"note\">No photo was taken.</p>\n</section>\n");
        return;
    }
    page.push_str("<table>\n<thead><tr><th scope=\"col\">Photo</th>");
    for (name, unit) in [
        ("Time", "s"),
        ("North", "m"),
        ("East", "m"),
        ("Height", "m"),
        ("Error", "m"),
        ("Speed", "m/s"),
        ("Tilt", "°"),
    ] {
        add(
            page,
            format_args!("<th scope=\"col\">{name}<span>{unit}</span></th>"),
        );
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for (index, photo) in photos.iter().enumerate() {
        let [north, east, down] = photo.position;
        add(page, format_args!("<tr><td>{}</td>", index + 1));
        let values = [
            (photo.time, 1),
            (north, 2),
            (east, 2),
            (-down, 2),
            (photo.position_error, 3),
            (photo.speed, 3),
            (photo.tilt, 1),
        ];
        for (value, digits) in values {
            add(page, format_args!("<td>{}</td>", number(value, digits)));
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody>\n</table>\n</section>\n");
}

fn events(page: &mut String, report: &Report) {
    if report.events.is_empty() {
        return;
    }
    page.push_str(
        "<section>\n<h2>Events</h2>\n<p class=\"note\">Their numbers stand above the dotted lines in the plots \
         over time.</p>\n<ol class=\"events\">\n",
    );
    for event in report.events.iter().take(MOST_EVENTS) {
        let (time, text) = (number(event.time, 1), escape(&event.text));
        add(page, format_args!("<li><time>{time} s</time> {text}</li>\n"));
    }
    page.push_str("</ol>\n");
    if let Some(more @ 1..) = report.events.len().checked_sub(MOST_EVENTS) {
        add(
            page,
            format_args!("<p class=\"note\">And {more} more, which are in the log.</p>\n"),
        );
    }
    page.push_str("</section>\n");
}

/// A number with a true minus and never a negative zero; a dash for none.
fn number(value: f32, digits: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        None => text,
        Some(rest) if rest.bytes().all(|b| matches!(b, b'0' | b'.')) => rest.into(),
        Some(rest) => once("−").chain(once(rest)).collect(),
    }
}

/// Text as HTML, in elements and in quoted attributes.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Appends formatted text; a `String` takes everything.
fn add(page: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = page.write_fmt(text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(number(-1.25, 1), "−1.2");
        assert_eq!(number(-0.001, 2), "0.00");
        assert_eq!(number(12.0, 0), "12");
        assert_eq!(number(f32::NAN, 2), "–");
    }

    #[test]
    fn only_the_drawing_library_is_embedded() {
        let sources = Plot::offline_js_sources();
        let library = library(&sources);
        assert!(library.starts_with("<script") && library.ends_with("</script>"));
        assert!(library.contains("plotly.js v3"));
        assert!(library.len() < 5_000_000, "{}", library.len());
    }
}
