//! A whole image in one call: which label goes on as which, and where the segment of a label is.

use crate::event::Event;

/// Elements of the work memory for each label.
pub(crate) const WORK_PER_LABEL: usize = 2;

/// What is known of a label. All zeros: it is its own, and has no segment.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub(crate) struct Entry {
    /// The smaller label that it was joined into; 0 for none.
    into: u32,
    /// The event of its segment: its place in the array plus 1, `LOST`, or 0 for none.
    event: u32,
}

const LOST: u32 = u32::MAX;

/// The caller's array of events.
pub(crate) struct Events {
    array: *mut Event,
    capacity: usize,
    /// Events in the array.
    pub count: usize,
    /// Events that did not fit.
    pub lost: usize,
}

impl Events {
    /// # Safety
    /// There is room for `capacity` events at `array`, until this is dropped.
    pub unsafe fn new(array: *mut Event, capacity: usize) -> Events {
        Events { array, capacity, count: 0, lost: 0 }
    }

    pub fn push(&mut self, event: &Event) -> bool {
        let room = self.count < self.capacity;
        if room {
            self.count += 1;
            self.set(self.count - 1, event);
        } else {
            self.lost += 1;
        }
        room
    }

    fn get(&self, index: usize) -> Event {
        if index >= self.count {
            return Event::default();
        }
        // SAFETY: below `count`, which is within the capacity that the maker promised; it was
        // written before.
        unsafe { self.array.add(index).read() }
    }

    fn set(&mut self, index: usize, event: &Event) {
        if index < self.count {
            // SAFETY: as in `get`.
            unsafe { self.array.add(index).write(*event) }
        }
    }
}

/// The labels of an image while it is segmented.
pub(crate) struct Labels<'a> {
    /// By label; 0 is none.
    entries: &'a mut [Entry],
}

impl<'a> Labels<'a> {
    /// `entries` are all zeros.
    pub fn new(entries: &'a mut [Entry]) -> Labels<'a> {
        Labels { entries }
    }

    fn entry(&mut self, label: u32) -> Option<&mut Entry> {
        self.entries.get_mut(label as usize)
    }

    /// Takes a segment, in the place of what was said of its label before.
    pub fn segment(&mut self, event: &Event, events: &mut Events) {
        let Some(entry) = self.entry(event.label) else { return };
        match entry.event {
            0 => {}
            LOST => events.lost -= 1,
            place => return events.set(place as usize - 1, event),
        }
        entry.event = if events.push(event) { events.count as u32 } else { LOST };
    }

    /// Takes a join: the segment of the label that ends is no more.
    pub fn join(&mut self, from: u32, into: u32, events: &mut Events) {
        let Some(entry) = self.entry(from) else { return };
        entry.into = into;
        match core::mem::take(&mut entry.event) {
            0 => {}
            LOST => events.lost -= 1,
            place => {
                // the last one takes its place
                let last = events.get(events.count - 1);
                events.set(place as usize - 1, &last);
                events.count -= 1;
                if let Some(entry) = self.entry(last.label).filter(|_| last.label != from) {
                    entry.event = place;
                }
            }
        }
    }

    /// Applies all joins, and puts the events in the order of their labels.
    pub fn finish(&mut self, events: &mut Events) {
        let mut next = 0;
        for label in 1..self.entries.len() as u32 {
            // joins go to smaller labels, which are final when a larger one asks
            let into = match self.find(label) {
                0 => label,
                into => self.find(into),
            };
            let Some(entry) = self.entry(label) else { return };
            entry.into = into;
            if entry.event == 0 || entry.event == LOST {
                continue;
            }
            let place = core::mem::replace(&mut entry.event, next as u32 + 1);
            let (event, other) = (events.get(place as usize - 1), events.get(next));
            events.set(next, &event);
            events.set(place as usize - 1, &other);
            if let Some(entry) = self.entry(other.label).filter(|_| other.label != label) {
                entry.event = place;
            }
            next += 1;
        }
    }

    /// What a label of the image is after `finish`; before, what it was joined into last.
    pub fn find(&self, label: u32) -> u32 {
        self.entries.get(label as usize).map_or(label, |entry| entry.into)
    }
}
