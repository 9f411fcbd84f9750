//! How close a check came to its limit, and how a group of them ended.

use crate::check::{Check, Outcome};

/// Measured over limit, whichever way round the check is: 1 is the limit, above it the check fails. 0 if nothing was
/// found at all, infinite if nothing was allowed.
pub fn severity(check: &Check) -> f64 {
    let (over, under) = if check.meaning.trim_end().ends_with('≥') {
        (check.limit, check.measured)
    } else {
        (check.measured, check.limit)
    };
    match over / under {
        _ if over <= 0.0 && under >= 0.0 => 0.0, // 0 of 0 allowed
        ratio if ratio.is_nan() => f64::INFINITY,
        ratio => ratio.max(0.0),
    }
}

/// The check that came closest to its limit or went farthest beyond, among those that ran; the first of equals.
pub fn worst<'a>(checks: impl Iterator<Item = &'a Check>) -> Option<&'a Check> {
    let mut worst: Option<&Check> = None;
    for check in checks.filter(|check| !matches!(check.outcome, Outcome::NotRun(_))) {
        if worst.is_none_or(|w| (check.failed(), severity(check)) > (w.failed(), severity(w))) {
            worst = Some(check);
        }
    }
    worst
}

/// Instruments in order of appearance, each with its checks.
pub fn groups(checks: &[Check]) -> Vec<(&str, Vec<&Check>)> {
    let mut groups: Vec<(&str, Vec<&Check>)> = Vec::new();
    for check in checks {
        match groups.iter_mut().find(|(name, _)| *name == check.instrument) {
            Some((_, group)) => group.push(check),
            None => groups.push((&check.instrument, vec![check])),
        }
    }
    groups
}

/// How a group ended: PASS, FAIL or NOT RUN.
pub fn verdict(group: &[&Check]) -> &'static str {
    if group.iter().any(|check| check.failed()) {
        "FAIL"
    } else if group.iter().any(|check| check.outcome == Outcome::Passed) {
        "PASS"
    } else {
        "NOT RUN"
    }
}

/// How many passed, failed, and could not run.
pub(crate) fn counts<'a>(checks: impl Iterator<Item = &'a Check>) -> [usize; 3] {
    checks.fold([0; 3], |[passed, failed, not_run], check| match check.outcome {
        Outcome::Passed => [passed + 1, failed, not_run],
        Outcome::Failed => [passed, failed + 1, not_run],
        Outcome::NotRun(_) => [passed, failed, not_run + 1],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(measured: f64, limit: f64, meaning: &str) -> Check {
        Check {
            instrument: "i".to_owned(),
            subject: "s".to_owned(),
            outcome: Outcome::Passed,
            measured,
            limit,
            meaning: meaning.to_owned(),
            detail: String::new(),
            seconds: 0.0,
        }
    }

    #[test]
    fn severity_is_one_at_the_limit_either_way_round() {
        assert_eq!(severity(&check(2.0, 4.0, "error ≤")), 0.5);
        assert_eq!(severity(&check(0.5, 0.25, "p ≥")), 0.5);
        assert_eq!(severity(&check(0.0, 0.0, "leaks ≤")), 0.0);
        assert_eq!(severity(&check(1.0, 0.0, "leaks ≤")), f64::INFINITY);
        assert_eq!(severity(&check(0.0, 1.0, "noticed ≥")), f64::INFINITY);
        assert_eq!(severity(&check(f64::NAN, 1.0, "error ≤")), f64::INFINITY);
    }
}
