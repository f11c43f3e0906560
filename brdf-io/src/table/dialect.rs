//! How a table is written: what separates fields and decimals, and which line is the header.

use std::borrow::Cow;

use crate::error::{FormatError, quoted};
use crate::note::ReadNote;

/// What separates the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    /// Commas.
    Comma,
    /// Semicolons.
    Semicolon,
    /// Tabs.
    Tab,
    /// Any white space.
    Space,
}

/// How numbers stand in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dialect {
    /// Between fields.
    pub(crate) separator: Separator,
    /// Decimals follow a comma instead of a point.
    pub(crate) decimal_comma: bool,
}

/// Marks that comments start with.
const MARKS: [&str; 6] = ["#", "%", "//", ";", "!", "*"];
/// Lines that tell the dialect.
const LOOKED_AT: usize = 64;
/// Fewest numbers of a row.
const FEWEST: usize = 3;
/// What stands for a value that is not there.
const NOT_THERE: [&str; 5] = ["", "-", "na", "n/a", "null"];

/// A line without the mark of a comment, and whether it had one.
pub(crate) fn uncommented(line: &str) -> (&str, bool) {
    let mut content = line.trim();
    let mut is_comment = false;
    while let Some(rest) = MARKS.iter().find_map(|mark| content.strip_prefix(mark)) {
        (content, is_comment) = (rest.trim_start(), true);
    }
    (content, is_comment)
}

impl Dialect {
    const ALL: [Self; 7] = {
        const fn of(separator: Separator, decimal_comma: bool) -> Dialect {
            Dialect { separator, decimal_comma }
        }
        [
            of(Separator::Comma, false),
            of(Separator::Semicolon, false),
            of(Separator::Semicolon, true),
            of(Separator::Tab, false),
            of(Separator::Tab, true),
            of(Separator::Space, false),
            of(Separator::Space, true),
        ]
    };

    /// Returns the dialect in which most lines are rows of numbers, if any line is.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let lines = text.lines().filter(|line| !line.trim().is_empty() && !uncommented(line).1);
        let lines: Vec<&str> = lines.take(LOOKED_AT).collect();
        // Where commas are decimals, fields without them are numbers either way: the numbers decide.
        let has_comma = lines.iter().any(|line| line.contains(','));
        let count = |dialect: Self| {
            if dialect.decimal_comma && !has_comma {
                return (0, 0);
            }
            let rows = lines.iter().filter_map(|line| dialect.numbers_of_row(line));
            rows.fold((0, 0), |(rows, all), own| (rows + 1, all + own))
        };
        let counted = Self::ALL.map(|dialect| (count(dialect), dialect));
        let most = counted.iter().map(|(count, _)| *count).max().filter(|(rows, _)| *rows > 0)?;
        counted.into_iter().find(|(count, _)| *count == most).map(|(_, dialect)| dialect)
    }

    /// What is to be said of it, if it is not the usual one.
    pub(crate) fn note(self) -> Option<ReadNote> {
        let by = match self.separator {
            Separator::Comma => "commas",
            Separator::Semicolon => "semicolons",
            Separator::Tab => "tabs",
            Separator::Space => "white space",
        };
        let is_usual = !self.decimal_comma && self.separator != Separator::Semicolon;
        (!is_usual).then_some(ReadNote::Dialect { by, decimal_comma: self.decimal_comma })
    }

    /// There are several numbers, and more of them than of other fields.
    pub(crate) fn is_row(self, line: &str) -> bool {
        !uncommented(line).1 && self.numbers_of_row(line).is_some()
    }

    fn numbers_of_row(self, line: &str) -> Option<usize> {
        if self.by().is_some_and(|by| !line.contains(char::from(by))) {
            return None;
        }
        let fields = self.split(line);
        let is_number = |field: &&Cow<'_, str>| self.parse(field).is_some_and(f64::is_finite);
        let numbers = fields.iter().filter(is_number).count();
        let is_row = numbers >= FEWEST.min(fields.len()).max(2) && 2 * numbers > fields.len();
        is_row.then_some(numbers)
    }

    /// What parts fields, if it is one character.
    fn by(self) -> Option<u8> {
        match self.separator {
            Separator::Comma => Some(b','),
            Separator::Semicolon => Some(b';'),
            Separator::Tab => Some(b'\t'),
            Separator::Space => None,
        }
    }

    /// Returns the fields of a line, without quotes and white space around them.
    pub(crate) fn split(self, line: &str) -> Vec<Cow<'_, str>> {
        let line = line.trim_matches(|c: char| c.is_whitespace() && c != '\t');
        let Some(by) = self.by() else {
            return line.split_whitespace().map(|field| field.trim_matches('"').into()).collect();
        };
        if !line.contains('"') {
            return line.split(char::from(by)).map(|field| field.trim().into()).collect();
        }
        quoted_fields(line, char::from(by))
    }

    /// Returns the number in a field, NaN where it says that there is none.
    pub(crate) fn parse(self, field: &str) -> Option<f64> {
        let field = field.trim();
        if NOT_THERE.iter().any(|word| field.eq_ignore_ascii_case(word)) {
            return Some(f64::NAN);
        }
        if !self.decimal_comma {
            return field.parse().ok();
        }
        // Points could only part thousands.
        if field.contains('.') { None } else { field.replacen(',', ".", 1).parse().ok() }
    }
}

/// The fields of a line of which some are in quotes (RFC 4180): separators within are text, two quotes are one.
fn quoted_fields(line: &str, by: char) -> Vec<Cow<'static, str>> {
    let (mut fields, mut field) = (Vec::new(), String::new());
    let mut is_quoted = false;
    let mut rest = line.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '"' if is_quoted && rest.peek() == Some(&'"') => field.extend(rest.next()),
            '"' => is_quoted = !is_quoted,
            _ if c == by && !is_quoted => {
                fields.push(field.trim().to_owned().into());
                field.clear();
            }
            _ => field.push(c),
        }
    }
    fields.push(field.trim().to_owned().into());
    fields
}

/// A header, and the rows below it.
pub(crate) struct Table<'a> {
    pub(crate) dialect: Dialect,
    /// Names of the columns; none without a header.
    pub(crate) header: Vec<String>,
    /// Units from a line of their own below the header, or empty.
    pub(crate) units: Vec<String>,
    /// Line of the header, counted from 1; 0 without one.
    pub(crate) header_line: usize,
    text: &'a str,
    /// Lines before the first row.
    above: usize,
}

/// A row of a table.
pub(crate) struct Row<'a> {
    pub(crate) line: usize,
    pub(crate) fields: Vec<Cow<'a, str>>,
}

impl<'a> Table<'a> {
    /// Finds the header: the last line before the first row of numbers, comment or not, with as many names as that row
    /// has numbers.
    pub(crate) fn new(text: &'a str) -> Result<Self, FormatError> {
        let missing = || FormatError::Missing {
            what: "header that names the columns".to_owned(),
            expected: "one line of names, then rows of numbers".to_owned(),
        };
        let Some(dialect) = Dialect::of(text) else {
            return Self::without_rows(text).ok_or_else(missing);
        };
        let mut names: Vec<(Vec<String>, usize)> = Vec::new();
        for (index, line) in text.lines().enumerate() {
            if dialect.is_row(line) {
                let count = dialect.split(line).len();
                names.retain(|(names, _)| names.len() >= count);
                let last = names.pop();
                let (units, last) = match last {
                    Some((units, _)) if units.iter().all(|unit| is_unit(unit)) => {
                        (units, names.pop())
                    }
                    other => (Vec::new(), other),
                };
                let (header, header_line) = last.unwrap_or_default();
                return Ok(Self { dialect, header, units, header_line, text, above: index });
            }
            names.push((names_of(dialect, line), index + 1));
        }
        Err(missing())
    }

    /// A header alone is a table without rows.
    fn without_rows(text: &'a str) -> Option<Self> {
        Dialect::ALL.into_iter().find_map(|dialect| {
            let named = text.lines().enumerate().filter_map(|(index, line)| {
                let names = names_of(dialect, line);
                let is_header = names.iter().any(|name| super::columns::is_exact(name));
                is_header.then_some((names, index + 1))
            });
            let (header, header_line) = named.last()?;
            let above = text.lines().count();
            Some(Self { dialect, header, units: Vec::new(), header_line, text, above })
        })
    }

    /// Rows below the header.
    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'a>> + use<'a> {
        let (text, above, dialect) = (self.text, self.above, self.dialect);
        text.lines()
            .enumerate()
            .skip(above)
            .filter(|(_, line)| !line.trim().is_empty() && !uncommented(line).1)
            // An editor of old ends files with it.
            .filter(|(_, line)| line.trim() != "\u{1a}")
            .map(move |(index, line)| Row { line: index + 1, fields: dialect.split(line) })
    }

    /// One number of a row.
    pub(crate) fn number(&self, row: &Row<'_>, index: usize) -> Result<f64, FormatError> {
        let field = row.fields.get(index).map(|field| self.dialect.parse(field));
        field.flatten().ok_or_else(|| FormatError::Line {
            line: row.line,
            found: match row.fields.get(index) {
                Some(field) if !field.is_empty() => quoted(field),
                _ => format!("{} fields", row.fields.len()),
            },
            expected: format!("a number in column {}", index + 1),
        })
    }
}

/// The names in a line, whose fields are parted as those of rows are, or else by what parts more of them.
fn names_of(dialect: Dialect, line: &str) -> Vec<String> {
    let (content, _) = uncommented(line);
    // What ASTM E1392 calls the line.
    let content = content.strip_prefix("VARS ").unwrap_or(content);
    if content.is_empty() {
        return Vec::new();
    }
    let own = dialect.split(content);
    let fields = if own.len() > 1 {
        own
    } else {
        let others = Dialect::ALL.map(|other| other.split(content));
        others.into_iter().max_by_key(Vec::len).unwrap_or(own)
    };
    fields.into_iter().map(Cow::into_owned).collect()
}

/// What stands in a line of units.
fn is_unit(text: &str) -> bool {
    const UNITS: [&str; 20] = [
        "", "-", "deg", "degree", "degrees", "°", "rad", "radian", "radians", "nm", "um", "µm",
        "1/sr", "sr^-1", "sr-1", "sr⁻¹", "1", "none", "%", "#",
    ];
    let text = text.trim().trim_matches(|c| matches!(c, '(' | ')' | '[' | ']')).to_lowercase();
    UNITS.contains(&text.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_hold_separators_and_quotes() {
        let comma = Dialect { separator: Separator::Comma, decimal_comma: false };
        let fields = comma.split(r#""Theta I, (deg)", "a ""b""" ,3,"", x"#);
        assert_eq!(fields, ["Theta I, (deg)", "a \"b\"", "3", "", "x"]);
    }
}
