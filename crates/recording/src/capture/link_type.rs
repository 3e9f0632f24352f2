//! Types of link-layer headers, as tcpdump.org numbers them.

/// IEEE 802.11 with radiotap headers.
pub const RADIOTAP: u16 = 127;
/// IEEE 802.15.4; frames end with their check sequence.
pub const WITH_FCS: u16 = 195;
/// IEEE 802.15.4; frames end without a check sequence.
pub const WITHOUT_FCS: u16 = 230;
/// IEEE 802.15.4 with TAP headers.
pub const TAP: u16 = 283;

/// What frames of other types are of.
const NAMES: [(u16, &str); 23] = [
    (0, "BSD loopback"),
    (1, "Ethernet"),
    (9, "PPP"),
    (101, "IP without a link layer"),
    (105, "IEEE 802.11 without radiotap"),
    (108, "OpenBSD loopback"),
    (113, "Linux, any interface"),
    (119, "IEEE 802.11 with Prism headers"),
    (RADIOTAP, "IEEE 802.11 radiotap"),
    (163, "IEEE 802.11 with AVS headers"),
    (187, "Bluetooth HCI"),
    (189, "USB, Linux"),
    (WITH_FCS, "IEEE 802.15.4 with FCS"),
    (201, "Bluetooth HCI"),
    (215, "IEEE 802.15.4 with the header of the PHY"),
    (220, "USB, Linux"),
    (WITHOUT_FCS, "IEEE 802.15.4 without FCS"),
    (249, "USB, Windows"),
    (251, "Bluetooth Low Energy"),
    (256, "Bluetooth Low Energy"),
    (272, "nRF sniffer, Bluetooth Low Energy"),
    (276, "Linux, any interface"),
    (TAP, "IEEE 802.15.4 TAP"),
];

/// The name of a type, if it is a common one.
#[must_use]
pub fn name(link: u16) -> &'static str {
    NAMES.iter().find(|(known, _)| *known == link).map_or("unknown", |(_, name)| name)
}
