//! What the command says: text that is safe for a terminal, in lines of bounded length.

use std::error::Error;
use std::fmt;
use std::io::{self, ErrorKind, Write};

use crate::command::output::Failure;

/// A longer word, such as a path or a key, is cut in its middle.
const MOST_OF_WORD: usize = 120;
/// A longer message is cut in its middle.
const MOST_OF_MESSAGE: usize = 2000;

/// Whoever read stdout has gone: there is nobody left to work for, and nothing is wrong.
#[derive(Debug)]
pub struct ReaderGone;

impl fmt::Display for ReaderGone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stdout: its reader has gone")
    }
}

impl Error for ReaderGone {}

/// Prints to stdout.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout();
    let written = stdout.write_all(plain(text).as_bytes()).and_then(|()| stdout.flush());
    written.map_err(stdout_failure)
}

/// Returns what a failure to write to stdout means.
pub fn stdout_failure(e: io::Error) -> Failure {
    if e.kind() == ErrorKind::BrokenPipe { ReaderGone.into() } else { format!("stdout: {e}").into() }
}

/// Says on stderr what went wrong, in one line.
pub fn error(e: &Failure) {
    tell(&e.to_string());
}

/// Says on stderr what looks wrong, in one line.
pub fn warn(what: &str) {
    tell(&format!("warning: {what}"));
}

fn tell(what: &str) {
    // if nobody reads it there is nobody to tell
    _ = io::stderr().write_all(format!("scanseg: {}\n", line(what)).as_bytes());
}

/// Returns the text with control characters, but for ends of lines, written as escapes.
fn plain(text: &str) -> String {
    let escaped = |c: char| c != '\n' && (c.is_control() || turns_text(c));
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if escaped(c) { plain.extend(c.escape_default()) } else { plain.push(c) }
    }
    plain
}

/// Whether it is not seen itself and changes the order in which others are.
fn turns_text(c: char) -> bool {
    matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// Returns a message as one line, long words and long lines cut.
fn line(message: &str) -> String {
    let message = plain(&message.replace('\n', " "));
    let words: Vec<String> = message.split(' ').map(|word| cut(word, MOST_OF_WORD)).collect();
    cut(&words.join(" "), MOST_OF_MESSAGE)
}

/// Returns the text, or its beginning and its end if it has more than so many characters.
fn cut(text: &str, most: usize) -> String {
    let characters: Vec<char> = text.chars().collect();
    if characters.len() <= most {
        return text.to_string();
    }
    let part = (most - 3) / 2;
    let end = characters.len() - part;
    characters[..part].iter().chain(&['.'; 3]).chain(&characters[end..]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped() {
        assert_eq!(plain("a\x1b[31mb\0c\rd\x07e\u{9b}f\u{202e}g\nh \u{e4}"), {
            "a\\u{1b}[31mb\\u{0}c\\rd\\u{7}e\\u{9b}f\\u{202e}g\nh \u{e4}"
        });
        assert_eq!(line("two\nlines\r\n"), "two lines\\r ");
    }

    #[test]
    fn long_words_and_lines_are_cut() {
        let long = line(&format!("{}/name.pgm: not there", "x".repeat(5000)));
        assert!(long.len() < 150 && long.ends_with("xx/name.pgm: not there") && long.contains("..."), "{long}");
        let many = line(&"word ".repeat(5000));
        assert!(many.chars().count() <= MOST_OF_MESSAGE, "{}", many.len());
        assert_eq!(line(&"\u{e4}".repeat(120)), "\u{e4}".repeat(120));
    }
}
