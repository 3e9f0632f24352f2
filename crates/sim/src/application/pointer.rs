//! Applications behind pointers: a caller may keep an application and lend it, or hide its type.

use super::Application;

macro_rules! pointed_at {
    ($self:ident.$method:ident($($argument:expr),*)) => {
        (**$self).$method($($argument),*)
    };
}

impl<A: Application + ?Sized> Application for &mut A {
    crate::pass_on!(pointed_at);
}

impl<A: Application + ?Sized> Application for Box<A> {
    crate::pass_on!(pointed_at);
}
