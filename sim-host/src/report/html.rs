//! Parts of self-contained HTML pages: the frame with its style, figures, tables.

use super::figure::Picture;

const STYLE: &str = include_str!("html.css");

/// A page. `title` is plain text, `style` further CSS, `body` HTML.
pub(crate) fn page(title: &str, style: &str, body: &str) -> String {
    let title = escaped(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}{style}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    )
}

/// Plain text as HTML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A figure with a caption in plain text. `name` is the figure's own on the page.
pub(crate) fn figure(name: &str, picture: &Picture, caption: &str) -> String {
    // Identifiers inside an SVG must be unique on the page.
    let own = |mark: &str| format!("{mark}{name}-");
    let svg =
        ["id=\"", "url(#", "href=\"#"].iter().fold(picture.svg(), |svg, mark| svg.replace(mark, &own(mark)));
    format!("<figure>\n{svg}\n<figcaption>{}</figcaption>\n</figure>\n", escaped(caption))
}

/// A table. The caption and the columns' names are plain text, the cells HTML.
pub(crate) fn table(caption: &str, columns: &[impl AsRef<str>], rows: &[Vec<String>]) -> String {
    let row = |cells: &mut dyn Iterator<Item = String>, tag: &str| {
        let cells: String = cells.map(|cell| format!("<{tag}>{cell}</{tag}>")).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let head = row(&mut columns.iter().map(|name| escaped(name.as_ref())), "th");
    let rows: String = rows.iter().map(|cells| row(&mut cells.iter().cloned(), "td")).collect();
    let caption = escaped(caption);
    format!(
        "<div class=\"wide\"><table>\n<caption>{caption}</caption>\n<thead>{head}</thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}
