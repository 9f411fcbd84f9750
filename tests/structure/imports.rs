//! What a module imports: A imports B if code of A that is no test names an item of B by any path.
//!
//! A path that leads through a `pub use` counts for the module that defines the item. A parent's `mod` and `pub use` of its
//! children do not count. Macros are read as tokens: whatever looks like a path is one. In the text of a `macro_rules!` only paths from
//! `$crate` or `crate` count, because others mean what they mean where the macro is called.

use super::cycles::Graph;
use super::modules::{Crate, Target, attributes, is_test, leaves};
use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItem, Item, ItemMacro, ItemMod, ItemUse, Macro, Path, TraitItem, VisRestricted, Visibility};

/// The imports of a crate's modules.
pub(crate) fn of(program: &Crate) -> Graph {
    let mut graph = Graph::default();
    for scope in 0..program.scopes.len() {
        let mut names = Names { program, scope, graph: &mut graph, in_rules: false };
        program.scopes[scope].items.iter().for_each(|item| names.visit_item(item));
    }
    graph
}

/// Enters into the graph what the code of one scope names.
struct Names<'a> {
    program: &'a Crate,
    scope: usize,
    graph: &'a mut Graph,
    /// Within the text of a `macro_rules!`.
    in_rules: bool,
}

impl Names<'_> {
    /// A path in code: an item counts, a module alone does not.
    fn path(&mut self, path: &[String], line: usize) {
        if let Some(Target::Item(scope)) = self.program.resolve(self.scope, path) {
            self.import(scope, line);
        }
    }

    fn import(&mut self, scope: usize, line: usize) {
        let (from, to) = (&self.program.scopes[self.scope], &self.program.scopes[scope]);
        if from.file != to.file {
            self.graph.enter(&from.module, &to.module, format!("{}:{line}", from.file));
        }
    }

    /// A macro's name: a path, or a bare name that is known from where it was defined.
    fn macro_name(&mut self, path: &[String], line: usize) {
        let bare = if let [name] = path { self.program.macro_named(name) } else { None };
        match (self.program.resolve(self.scope, path), bare) {
            (Some(Target::Item(scope)), _) | (None, Some(scope)) => self.import(scope, line),
            _ => {}
        }
    }

    /// Paths in the tokens of a macro. A single small word may be a variable: it counts only as what is called.
    fn tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let punct = |i: usize, sign: char| matches!(tokens.get(i), Some(TokenTree::Punct(p)) if p.as_char() == sign);
        let mut i = 0;
        while i < tokens.len() {
            match &tokens[i] {
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Ident(first) => {
                    let is_field = i > 0 && punct(i - 1, '.') && !(i > 1 && punct(i - 2, '.'));
                    let is_variable = i > 0 && punct(i - 1, '$') && first != "crate";
                    let continues = i > 1 && punct(i - 1, ':') && punct(i - 2, ':');
                    let mut path = vec![first.to_string()];
                    while let (true, true, Some(TokenTree::Ident(next))) =
                        (punct(i + 1, ':'), punct(i + 2, ':'), tokens.get(i + 3))
                    {
                        path.push(next.to_string());
                        i += 3;
                    }
                    let line = first.span().start().line;
                    let is_called = matches!(tokens.get(i + 1), Some(TokenTree::Group(_)));
                    let is_small = path.len() == 1 && path[0].starts_with(|c: char| c.is_lowercase());
                    if is_field || is_variable || continues || (self.in_rules && first != "crate") {
                        // The name of a field or method, of a macro's variable, the end of a path that starts elsewhere, or known to a macro's callers.
                    } else if punct(i + 1, '!') && matches!(tokens.get(i + 2), Some(TokenTree::Group(_))) {
                        self.macro_name(&path, line);
                    } else if !is_small || is_called {
                        self.path(&path, line);
                    }
                }
                _ => {}
            }
            i += 1;
        }
    }
}

impl<'ast> Visit<'ast> for Names<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_test(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        if !matches!(item, ImplItem::Fn(method) if is_test(&method.attrs)) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_trait_item(&mut self, item: &'ast TraitItem) {
        if !matches!(item, TraitItem::Fn(method) if is_test(&method.attrs)) {
            visit::visit_trait_item(self, item);
        }
    }

    /// Modules are scopes of their own.
    fn visit_item_mod(&mut self, _: &'ast ItemMod) {}

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_vis_restricted(&mut self, _: &'ast VisRestricted) {}

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let is_public = !matches!(item.vis, Visibility::Inherited);
        for leaf in leaves(item) {
            if is_public && self.program.starts_at_child(self.scope, &leaf.path) {
                continue;
            }
            match self.program.resolve(self.scope, &leaf.path) {
                Some(Target::Scope(scope)) if leaf.name == "*" => self.import(scope, leaf.line),
                Some(Target::Item(scope)) => self.import(scope, leaf.line),
                _ => {}
            }
        }
    }

    fn visit_path(&mut self, path: &'ast Path) {
        if let (None, Some(first)) = (&path.leading_colon, path.segments.first()) {
            let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            self.path(&names, first.ident.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_item_macro(&mut self, item: &'ast ItemMacro) {
        self.in_rules = item.ident.is_some();
        visit::visit_item_macro(self, item);
        self.in_rules = false;
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        if let Some(first) = call.path.segments.first() {
            let names: Vec<String> = call.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            self.macro_name(&names, first.ident.span().start().line);
        }
        self.tokens(call.tokens.clone());
    }
}
