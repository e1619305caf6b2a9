//! Results that several items need, computed once.

use std::sync::{Arc, Mutex, PoisonError};

/// Results by their keys.
#[derive(Debug)]
pub(super) struct Memo<K, V>(Mutex<Vec<(K, Arc<V>)>>);

impl<K, V> Default for Memo<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: PartialEq, V> Memo<K, V> {
    /// The result of a key, if it is stored.
    pub(super) fn stored(&self, key: &K) -> Option<Arc<V>> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.iter().find(|(of, _)| of == key).map(|(_, result)| result.clone())
    }

    /// Stores the result of a key.
    pub(super) fn store(&self, key: K, result: V) -> Arc<V> {
        let result = Arc::new(result);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((key, result.clone()));
        result
    }

    /// The result of a key, stored or computed now. It is not locked meanwhile: threads that need it at the same time both compute it.
    pub(super) fn get(&self, key: K, compute: impl FnOnce() -> V) -> Arc<V> {
        self.stored(&key).unwrap_or_else(|| self.store(key, compute()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_is_computed_once_for_each_key() {
        let memo = Memo::default();
        let of = |key: u32| memo.get(key, || key + 1);
        assert_eq!((*of(1), *of(2)), (2, 3));
        assert_eq!(*memo.get(1, || panic!("computed again")), 2);
        assert!(memo.stored(&3).is_none());
    }
}
