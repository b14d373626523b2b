//! Builds blueprints: views in containers, and their properties.

use rerun::blueprint::components::ContainerKind;
use rerun::components::Name;
use rerun::datatypes;
use rerun::external::re_log_types::StoreKind;
use rerun::external::re_log_types::{BlueprintActivationCommand, LogMsg};
use rerun::external::re_sdk_types::blueprint::archetypes as parts;
use rerun::external::re_sdk_types::blueprint::components;
use rerun::{AsComponents, Clear, StoreId, TimePoint, Timeline};

use crate::rerun::error::RerunError;
use crate::rerun::output::message::{Ids, opening, single_row};

/// The messages of a layout; the last one activates it.
pub(crate) type Messages = Vec<Result<LogMsg, RerunError>>;

/// A view or a container: a part of a layout.
pub(in crate::rerun) struct Child {
    id: datatypes::Uuid,
    path: String,
}

/// Number after which new parts of a changed layout are numbered.
const REPLACEMENT: u64 = 1 << 16;

/// A blueprint under construction.
pub(in crate::rerun) struct BlueprintLayout {
    store: StoreId,
    ids: Ids,
    children: u64,
    /// The paths of all parts.
    paths: Vec<String>,
    messages: Messages,
}

impl BlueprintLayout {
    /// An empty layout for a recording.
    pub(in crate::rerun) fn new(recording: &StoreId) -> Self {
        let mut layout = Self {
            ids: Ids::BLUEPRINT,
            ..Self::changes(recording)
        };
        let opening = opening(&layout.store, &mut layout.ids);
        layout.messages.push(Ok(opening));
        layout
    }

    /// Changes to the layout of a recording, which has been sent before.
    pub(in crate::rerun) fn changes(recording: &StoreId) -> Self {
        let application = recording.application_id().clone();
        let id = recording.recording_id().as_str();
        Self {
            store: StoreId::new(StoreKind::Blueprint, application, id),
            ids: Ids::BLUEPRINT_AT_END,
            children: 0,
            paths: Vec::new(),
            messages: Vec::new(),
        }
    }

    /// Makes the following parts new ones, which inherit no properties of the parts that were sent before.
    pub(in crate::rerun) fn start_new_parts(&mut self) {
        self.children = REPLACEMENT;
    }

    /// Sets components of a part of the layout.
    pub(in crate::rerun) fn log(&mut self, path: &str, components: &dyn AsComponents) {
        // The timeline on which viewers keep the history of a layout.
        let time = TimePoint::default().with(Timeline::new_sequence("blueprint"), 0);
        let row = single_row(&self.store, &mut self.ids, path, time, components);
        self.messages.push(row);
    }

    /// The next part with a unique identifier.
    fn child(&mut self, prefix: &str) -> Child {
        self.children += 1;
        let number = self.children;
        // Viewers find a part by its UUID. A random one would make each recording a different file.
        let mut bytes = [0; 16];
        bytes[8..].copy_from_slice(&number.to_be_bytes());
        let (high, low) = (number >> 48, number & 0xFFFF_FFFF_FFFF);
        let path = format!("{prefix}/00000000-0000-0000-{high:04x}-{low:012x}");
        self.paths.push(path.clone());
        Child {
            id: datatypes::Uuid { bytes },
            path,
        }
    }

    /// A view of these entities.
    pub(in crate::rerun) fn view(
        &mut self,
        class: &str,
        name: &str,
        origin: &str,
        contents: &[impl AsRef<str>],
    ) -> Child {
        let view = self.child("view");
        let blueprint = parts::ViewBlueprint::new(class)
            .with_display_name(Name(name.into()))
            .with_space_origin(origin);
        let query = contents
            .iter()
            .map(|entity| components::QueryExpression(format!("+ {}", entity.as_ref()).into()));
        self.log(&view.path, &blueprint);
        self.property(&view, "ViewContents", &parts::ViewContents::new(query));
        view
    }

    /// Sets a property of a view.
    pub(in crate::rerun) fn property(
        &mut self,
        view: &Child,
        name: &str,
        components: &dyn AsComponents,
    ) {
        self.log(&format!("{}/{name}", view.path), components);
    }

    /// Puts parts into a container, which shows the first of them if they are tabs.
    pub(in crate::rerun) fn contain(
        &mut self,
        container: parts::ContainerBlueprint,
        children: &[Child],
    ) -> Child {
        let child = self.child("container");
        let contents = children
            .iter()
            .map(|child| components::IncludedContent(child.path.as_str().into()));
        let mut filled = container.with_contents(contents);
        if let Some(first) = children.first() {
            filled = filled.with_active_tab(components::ActiveTab(first.path.as_str().into()));
        }
        self.log(&child.path, &filled);
        child
    }

    /// Puts parts into a container, if there are any.
    pub(in crate::rerun) fn contain_any(
        &mut self,
        container: parts::ContainerBlueprint,
        children: &[Child],
    ) -> Option<Child> {
        (!children.is_empty()).then(|| self.contain(container, children))
    }

    /// Fills the window with a container.
    pub(in crate::rerun) fn fill(&mut self, root: &Child) {
        let viewport = parts::ViewportBlueprint::new()
            .with_root_container(components::RootContainer(root.id))
            // Otherwise the viewer adds views of its own.
            .with_auto_layout(false)
            .with_auto_views(false);
        self.log("viewport", &viewport);
    }

    /// Removes the parts of the layout that was sent before which this one has not. Otherwise they would still name parts
    /// of this one as theirs, and a part has one container.
    pub(in crate::rerun) fn remove_missing(&mut self, before: &Self) {
        for path in &before.paths {
            if !self.paths.contains(path) {
                self.log(path, &Clear::recursive());
            }
        }
    }

    /// All messages of the layout.
    pub(in crate::rerun) fn finish(mut self) -> Messages {
        let activation = BlueprintActivationCommand {
            blueprint_id: self.store,
            // Not only the default: a viewer that has made a layout of its own before keeps that one.
            make_active: true,
            make_default: true,
        };
        let activation = LogMsg::BlueprintActivationCommand(activation);
        self.messages.push(Ok(activation));
        self.messages
    }
}

/// A row with these shares of its width; equal shares if none are specified.
pub(in crate::rerun) fn row(shares: &[f32]) -> parts::ContainerBlueprint {
    let row = parts::ContainerBlueprint::new(ContainerKind::Horizontal);
    row.with_col_shares(shares.iter().copied())
}

/// A column with these shares of its height; equal shares if none are specified.
pub(in crate::rerun) fn column(shares: &[f32]) -> parts::ContainerBlueprint {
    let column = parts::ContainerBlueprint::new(ContainerKind::Vertical);
    column.with_row_shares(shares.iter().copied())
}

/// Tabs.
pub(in crate::rerun) fn tabs() -> parts::ContainerBlueprint {
    parts::ContainerBlueprint::new(ContainerKind::Tabs)
}
