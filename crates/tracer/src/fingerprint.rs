//! Fingerprints: equal things have equal ones, on every run. FNV-1a (Fowler, Noll & Vo 1991), 64 bits.

/// A hash that is being formed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fingerprint(u64);

impl Fingerprint {
    /// Of nothing yet.
    pub(crate) fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes in bytes, in order.
    #[inline]
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Takes in numbers, in order.
    #[inline]
    pub(crate) fn numbers(&mut self, numbers: impl IntoIterator<Item = f32>) {
        numbers.into_iter().for_each(|x| self.bytes(&x.to_le_bytes()));
    }

    /// Takes in a text, and that it ends.
    pub(crate) fn text_of(&mut self, text: &str) {
        self.bytes(text.as_bytes());
        self.bytes(&[0xff]); // which no text holds
    }

    /// In hexadecimal.
    pub(crate) fn text(self) -> String {
        format!("{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Fingerprint;

    #[test]
    fn it_is_that_of_the_publication() {
        let mut f = Fingerprint::new();
        f.bytes(b"foobar");
        assert_eq!(f.text(), "85944171f73967e8");
    }
}
