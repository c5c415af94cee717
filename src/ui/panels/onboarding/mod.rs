//! Introduction for new users, drawn over the picture.

pub(crate) mod card;
pub(crate) mod coach;
