//! The slip of a run: the slip speeds that it visits, and the coefficients of friction there.

mod comparison;
mod history;
mod speeds;

pub use self::comparison::SlipComparison;
pub(crate) use self::history::SlipHistory;
pub use self::history::{PathPoint, Slip, SlipPoint};
pub use self::speeds::{SpeedBin, VisitedSpeeds};
