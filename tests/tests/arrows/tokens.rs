//! Source text as words and marks.

/// Words, `::` and single characters; comments, literals and lifetimes left out.
pub fn tokens(source: &str) -> Vec<String> {
    let mut tokens = vec![];
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let word = rest.len() - rest.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_').len();
        let hashes = rest[word..].len() - rest[word..].trim_start_matches('#').len();
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if ["r", "br", "cr"].contains(&&rest[..word]) && rest[word + hashes..].starts_with('"') {
            let begin = word + hashes + 1;
            let end = format!("\"{}", "#".repeat(hashes));
            rest[begin..].find(&end).map_or(rest.len(), |at| begin + at + end.len())
        } else if first == '"'
            || first == '\'' && (rest[1..].starts_with('\\') || rest[1..].chars().nth(1) == Some('\''))
        {
            1 + quoted(&rest[1..], first)
        } else if first == '\'' {
            1 + rest[1..].len() - rest[1..].trim_start_matches(|c: char| c.is_alphanumeric() || c == '_').len()
        } else {
            let length = if rest.starts_with("::") { 2 } else { word.max(first.len_utf8()) };
            tokens.extend((!first.is_whitespace()).then(|| rest[..length].to_owned()));
            length
        };
        rest = &rest[length..];
    }
    tokens
}

/// Bytes up to and with the quote that ends a literal.
fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    let end = text.char_indices().find(|(_, c)| {
        let ends = *c == quote && !escaped;
        escaped = *c == '\\' && !escaped;
        ends
    });
    end.map_or(text.len(), |(at, c)| at + c.len_utf8())
}

/// The paths of a `use`, each with the name that it gives. Returns where the next token stands.
pub fn use_paths(tokens: &[String], mut i: usize, before: &[String], into: &mut Vec<(Vec<String>, String)>) -> usize {
    let mut path = before.to_vec();
    loop {
        match tokens[i].as_str() {
            "::" => (),
            "{" => {
                while tokens[i] != "}" {
                    i = if tokens[i + 1] == "}" { i + 1 } else { use_paths(tokens, i + 1, &path, into) };
                }
                return i + 1;
            }
            "as" => {
                into.push((path, tokens[i + 1].clone()));
                return i + 2;
            }
            "," | "}" | ";" => {
                let name = path.last().cloned().unwrap_or_default();
                into.push((path, name));
                return i;
            }
            "*" => {
                into.push((path, "*".to_owned()));
                return i + 1;
            }
            // the module itself, beside what is in it
            "self" if !path.is_empty() => (),
            word => path.push(word.to_owned()),
        }
        i += 1;
    }
}

pub fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Drops each item under `#[cfg(test)]` or `#[cfg(doctest)]`: up to its semicolon, or the end of
/// its braces.
pub fn without_tests(tokens: Vec<String>) -> Vec<String> {
    let mut kept = vec![];
    let mut i = 0;
    while i < tokens.len() {
        let attribute = tokens[i..].iter().take(7).map(String::as_str).collect::<String>();
        if !["#[cfg(test)]", "#[cfg(doctest)]"].contains(&attribute.as_str()) {
            kept.push(tokens[i].clone());
            i += 1;
            continue;
        }
        let mut depth = 0;
        i += 7;
        while i < tokens.len() {
            let token = tokens[i].as_str();
            depth += i32::from("{[(".contains(token)) - i32::from("}])".contains(token));
            i += 1;
            if depth == 0 && [";", "}"].contains(&token) {
                break;
            }
        }
    }
    kept
}
