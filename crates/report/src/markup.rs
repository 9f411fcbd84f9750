//! Text and markup: what a page is made of, and how text is kept from becoming markup.

/// A piece of a page. Text that becomes one is escaped; only this crate writes tags.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Html(String);

/// What a word in colour says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// It is as it should be.
    Good,
    /// It is not.
    Bad,
    /// It is not known, or allowed but worth a look.
    Open,
    /// It matters less than what is around it.
    Soft,
}

impl Tone {
    /// Its class in the style sheet.
    pub(crate) fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Bad => "bad",
            Self::Open => "none",
            Self::Soft => "soft",
        }
    }
}

impl Html {
    /// Markup of this crate's own.
    pub(crate) fn raw(markup: String) -> Self {
        Self(markup)
    }

    /// The markup.
    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }

    /// Text in a colour.
    pub fn toned(tone: Tone, text: &str) -> Self {
        Self(format!("<span class=\"{}\">{}</span>", tone.class(), escape(text)))
    }

    /// Text as it is typed into a computer.
    pub fn code(text: &str) -> Self {
        Self(format!("<code>{}</code>", escape(text)))
    }

    /// A link to the part of the page of that name, with the name as its text.
    pub fn link(name: &str) -> Self {
        Self(format!("<a href=\"#{0}\">{0}</a>", escape(name)))
    }

    /// This, and then that.
    #[must_use]
    pub fn and(self, next: impl Into<Self>) -> Self {
        Self(self.0 + &next.into().0)
    }

    /// With a line of smaller text below it; nothing for an empty one.
    #[must_use]
    pub fn detail(self, text: &str) -> Self {
        if text.is_empty() { self } else { Self(format!("{}<div class=\"detail\">{}</div>", self.0, escape(text))) }
    }
}

impl From<&str> for Html {
    fn from(text: &str) -> Self {
        Self(escape(text))
    }
}

impl From<String> for Html {
    fn from(text: String) -> Self {
        Self(escape(&text))
    }
}

/// Text that cannot become markup.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A PNG file as an address, for a page that loads nothing.
pub(crate) fn png_address(file: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(file))
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = group.iter().fold(0_u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - group.len()));
        for digit in 0..4 {
            let value = DIGITS[(word >> (18 - 6 * digit)) as usize & 63];
            text.push(if digit <= group.len() { char::from(value) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        for (plain, coded) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn text_cannot_become_markup() {
        assert_eq!(escape("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
        let piece = Html::from("<b>").and(Html::code("<i>")).detail("<u>");
        assert_eq!(piece.as_str(), "&lt;b&gt;<code>&lt;i&gt;</code><div class=\"detail\">&lt;u&gt;</div>");
        assert_eq!(Html::from("a").detail("").as_str(), "a");
    }
}
