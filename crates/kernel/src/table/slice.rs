//! The table itself, which knows no kind of number but `f32`.

/// A borrowed list of numbers with an id that tells it from other tables.
///
/// All lanes of a call look into the same table. Text that is made from a recording names the table by its id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<'t> {
    values: &'t [f32],
    id: u32,
}

impl<'t> Table<'t> {
    /// The table of these values. Tables that are used together have different ids.
    #[inline(always)]
    pub const fn new(values: &'t [f32], id: u32) -> Self {
        Self { values, id }
    }
    /// How many values there are.
    #[inline(always)]
    pub const fn len(&self) -> usize {
        self.values.len()
    }
    /// Whether there is no value: every look-up gives 0.
    #[inline(always)]
    pub const fn is_empty(&self) -> bool {
        self.values.is_empty()
    }
    /// The number by which the table is known.
    #[inline(always)]
    pub const fn id(&self) -> u32 {
        self.id
    }
    /// The values in order.
    #[inline(always)]
    pub const fn values(&self) -> &'t [f32] {
        self.values
    }
    /// The value at `index`, the last one beyond the end, 0 without any.
    #[inline(always)]
    pub(crate) fn at(&self, index: u32) -> f32 {
        let last = self.values.len().saturating_sub(1);
        self.values.get(last.min(index as usize)).copied().unwrap_or(0.0)
    }
}
