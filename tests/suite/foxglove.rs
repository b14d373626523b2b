//! The layout for Foxglove and Lichtblick: the top in 3D, plots of the table's fields, the log of events.
//!
//! Both import the same JSON. `configById` has the settings of each panel by an identifier `TYPE!NAME`; `layout` is a
//! tree of rows and columns of these identifiers.

use serde_json::{Map, Value, json};
use toprise::physics::dynamics::Support;
use toprise::telemetry::fields::{
    NumberField, contact, energy, free_peg, momentum, nutation, precession, state, torque,
};

/// A plot: its name in identifiers, its title, its fields with their labels.
type PlotDefinition = (
    &'static str,
    &'static str,
    &'static [(NumberField, &'static str)],
);

/// The plots of every run.
const MOTION: [PlotDefinition; 6] = [
    (
        "theta",
        "θ, inclination",
        &[(state::THETA, "θ"), (nutation::THETA_MEAN, "nutation mean")],
    ),
    (
        "phi_dot",
        "dφ/dt and the slow root of regular precession",
        &[
            (state::PHI_DOT, "dφ/dt"),
            (precession::SLOW_ROOT, "slow root"),
        ],
    ),
    ("psi_dot", "dψ/dt, spin", &[(state::PSI_DOT, "dψ/dt")]),
    (
        "torque",
        "Friction torque, node frame",
        &[
            (torque::FRICTION_NODE.x(), "line of nodes"),
            (torque::FRICTION_NODE.y(), "perpendicular"),
            (torque::FRICTION_NODE.z(), "symmetry axis"),
        ],
    ),
    ("slip", "Slip speed", &[(contact::SLIP_SPEED, "slip speed")]),
    (
        "energy",
        "Total and kinetic energy",
        &[(energy::TOTAL, "total"), (energy::KINETIC, "kinetic")],
    ),
];

/// The plots of a free peg.
const TABLE: [PlotDefinition; 4] = [
    (
        "normal_force",
        "Normal force",
        &[(contact::NORMAL_FORCE, "normal force")],
    ),
    (
        "gap",
        "Height of the peg above the table",
        &[(free_peg::GAP, "gap")],
    ),
    (
        "momentum",
        "Angular momentum",
        &[
            (momentum::VERTICAL, "vertical"),
            (momentum::AXIAL, "symmetry axis"),
        ],
    ),
    (
        "jellett",
        "Jellett's integral",
        &[(free_peg::JELLETT, "Jellett")],
    ),
];

const SCENE: &str = "3D!top";
const LOG: &str = "RosOut!events";
const PLOTS: &str = "Tab!plots";

/// The layout for tops with this support, as JSON.
pub fn foxglove_layout(support: Support) -> String {
    let mut tabs = vec![("Motion", &MOTION[..])];
    if support.is_free() {
        tabs.push(("On the table", &TABLE));
    }
    let mut panels = Map::new();
    panels.insert(SCENE.to_owned(), scene());
    panels.insert(
        LOG.to_owned(),
        json!({ "topicToRender": "/log", "minLogLevel": 1, "searchTerms": [] }),
    );
    for plot in tabs.iter().flat_map(|(_, plots)| *plots) {
        panels.insert(identifier(plot), settings(plot));
    }
    let tabs: Vec<_> = tabs
        .into_iter()
        .map(|(title, plots)| json!({ "title": title, "layout": grid(plots) }))
        .collect();
    panels.insert(PLOTS.to_owned(), json!({ "activeTabIdx": 0, "tabs": tabs }));
    let left = split("column", &json!(SCENE), &json!(LOG), 75);
    let layout = json!({
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": { "speed": 1 },
        "layout": split("row", &left, &json!(PLOTS), 42),
    });
    format!("{layout:#}\n")
}

/// The 3D panel: the camera goes along with a top that travels.
fn scene() -> Value {
    let mut topics = Map::new();
    for topic in ["/robot_description", "/view/arrows"] {
        topics.insert(topic.to_owned(), json!({ "visible": true }));
    }
    json!({
        "foxglovePanelTitle": "Top",
        "lichtblickPanelTitle": "Top",
        "cameraState": {
            "perspective": true,
            "distance": 0.3,
            "phi": 72,
            "thetaOffset": 38,
            "target": [0, 0, 0],
            "targetOffset": [0, 0, 0.03],
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.001,
            "far": 100,
        },
        "followMode": "follow-position",
        "followTf": "contact",
        "scene": { "backgroundColor": "#12151b", "transforms": { "showLabel": false, "axisScale": 0 } },
        "transforms": {},
        "topics": topics,
        "layers": {
            "table": {
                "layerId": "foxglove.Grid",
                "instanceId": "table",
                "label": "Table",
                "visible": true,
                "frameId": "world",
                "size": 1,
                "divisions": 40,
                "lineWidth": 1,
                "color": "#4a5260",
                "position": [0, 0, 0],
                "rotation": [0, 0, 0],
                "order": 1,
            },
        },
    })
}

fn identifier((name, ..): &PlotDefinition) -> String {
    format!("Plot!{name}")
}

/// The settings of a plot.
fn settings((_, title, fields): &PlotDefinition) -> Value {
    let paths: Vec<_> = fields
        .iter()
        .map(|(field, label)| {
            json!({
                "value": format!("{}.{}", field.topic().name(), field.path()),
                "label": label,
                "enabled": true,
                // The log time: the messages have no header with another stamp.
                "timestampMethod": "receiveTime",
            })
        })
        .collect();
    let title = match fields.first().map_or("", |(field, _)| field.unit()) {
        "" => (*title).to_owned(),
        unit => format!("{title} ({unit})"),
    };
    json!({
        "foxglovePanelTitle": title,
        "lichtblickPanelTitle": title,
        "paths": paths,
        "showXAxisLabels": true,
        "showYAxisLabels": true,
        "showLegend": fields.len() > 1,
        "legendDisplay": "floating",
        "showPlotValuesInLegend": false,
        "isSynced": true,
        "xAxisVal": "timestamp",
        "sidebarDimension": 240,
    })
}

/// Plots in rows of two.
fn grid(plots: &[PlotDefinition]) -> Value {
    let rows: Vec<_> = plots
        .chunks(2)
        .map(|pair| {
            stack(
                "row",
                pair.iter().map(|plot| json!(identifier(plot))).collect(),
            )
        })
        .collect();
    stack("column", rows)
}

/// Parts of equal size; `parts` is not empty.
fn stack(direction: &str, mut parts: Vec<Value>) -> Value {
    let mut whole = parts.pop().unwrap_or_default();
    let mut count = 1;
    while let Some(part) = parts.pop() {
        count += 1;
        // From the end: each part shares the space with all that follow.
        whole = split(direction, &part, &whole, 100 / count);
    }
    whole
}

/// Two parts, of which the first takes this percentage.
fn split(direction: &str, first: &Value, second: &Value, percentage: u32) -> Value {
    json!({
        "direction": direction,
        "first": first,
        "second": second,
        "splitPercentage": percentage,
    })
}
