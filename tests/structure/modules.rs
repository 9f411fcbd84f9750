//! The modules of a crate, read from its files, and the names that are known in each.
//!
//! A scope is a module of the language, inline ones included; a module in the sense of the test is a file. Tests are left out.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, HashMap};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemUse, Meta, UseTree};

/// A crate: its scopes, the root first, and the macros that are known by their bare names.
pub(crate) struct Crate {
    pub(crate) scopes: Vec<Scope>,
    macros: HashMap<String, usize>,
}

/// A module, inline or a file.
pub(crate) struct Scope {
    /// The name of the file's module, `crate` for the root.
    pub(crate) module: String,
    pub(crate) file: String,
    pub(crate) items: Vec<Item>,
    parent: usize,
    names: HashMap<String, Vec<Name>>,
    globs: Vec<Vec<String>>,
    /// Where files of modules in this one lie, and where `#[path]` starts.
    folder: String,
}

/// What a name stands for in a scope.
enum Name {
    Scope(usize),
    Item,
    /// The path of a `use`.
    Alias(Vec<String>),
}

/// What a path leads to: a module, or an item that the scope defines.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Target {
    Scope(usize),
    Item(usize),
}

/// A leaf of a `use`: the path, the name that it gets (`*` takes all), and the line.
pub(crate) struct Leaf {
    pub(crate) path: Vec<String>,
    pub(crate) name: String,
    pub(crate) line: usize,
}

impl Crate {
    /// Reads a crate from its files, by path and text; `root` is the path of the first.
    pub(crate) fn read(files: &BTreeMap<String, String>, root: &str) -> Result<Self, String> {
        let mut this = Self { scopes: Vec::new(), macros: HashMap::new() };
        let items = parsed(files, root)?;
        this.add(files, items, Scope::new("crate", root, 0, ""))?;
        Ok(this)
    }

    /// Adds a scope and those within it; its number.
    fn add(&mut self, files: &BTreeMap<String, String>, items: Vec<Item>, scope: Scope) -> Result<usize, String> {
        let at = self.scopes.len();
        self.scopes.push(scope);
        for item in items.iter().filter(|item| !is_test(attributes(item))) {
            match item {
                Item::Mod(module) => {
                    let name = module.ident.to_string();
                    let inner = self.module(files, at, module)?;
                    self.scopes[at].names.entry(name).or_default().push(Name::Scope(inner));
                }
                Item::Macro(rules) if rules.ident.is_some() => {
                    let name = rules.ident.as_ref().map(ToString::to_string).unwrap_or_default();
                    self.macros.insert(name.clone(), at);
                    if rules.attrs.iter().any(|attribute| attribute.path().is_ident("macro_export")) {
                        let path = self.path_of(at, &name);
                        self.scopes[0].names.entry(name.clone()).or_default().push(Name::Alias(path));
                    }
                    self.scopes[at].define(name);
                }
                _ => {
                    self.scopes[at].define_all(defined(item));
                    LocalUses { scope: &mut self.scopes[at] }.visit_item(item);
                }
            }
        }
        self.scopes[at].items = items;
        Ok(at)
    }

    fn module(&mut self, files: &BTreeMap<String, String>, at: usize, module: &syn::ItemMod) -> Result<usize, String> {
        let (parent, name) = (&self.scopes[at], module.ident.to_string());
        let folder = joined(&parent.folder, &name);
        if let Some((_, items)) = &module.content {
            let scope = Scope::new(&parent.module, &parent.file, at, &folder);
            return self.add(files, items.clone(), scope);
        }
        let given = module.attrs.iter().find_map(path_attribute).map(|path| joined(folder_of(&parent.file), &path));
        let candidates =
            given.map_or_else(|| vec![format!("{folder}.rs"), format!("{folder}/mod.rs")], |path| vec![path]);
        let file = candidates.into_iter().find(|file| files.contains_key(file));
        let file = file.ok_or_else(|| format!("{}: no file for the module {name}", parent.file))?;
        let items = parsed(files, &file)?;
        let scope = Scope::new(&folder.replace('/', "::"), &file, at, &folder);
        self.add(files, items, scope)
    }

    /// The path of an item of a scope from the root, by the numbers of scopes: `crate` and names that no file can have.
    fn path_of(&self, scope: usize, name: &str) -> Vec<String> {
        vec![format!("#{scope}"), name.to_owned()]
    }

    /// What a path in a scope leads to; nothing if it leaves the crate.
    pub(crate) fn resolve(&self, scope: usize, path: &[String]) -> Option<Target> {
        self.follow(scope, path, 0)
    }

    /// The scope of a macro of that name.
    pub(crate) fn macro_named(&self, name: &str) -> Option<usize> {
        self.macros.get(name).copied()
    }

    /// Whether the path starts at a module within this scope.
    pub(crate) fn starts_at_child(&self, scope: usize, path: &[String]) -> bool {
        let first = path.iter().find(|name| *name != "self");
        let names = first.and_then(|name| self.scopes[scope].names.get(name));
        names.is_some_and(|names| names.iter().any(|name| matches!(name, Name::Scope(_))))
    }

    fn follow(&self, scope: usize, path: &[String], depth: usize) -> Option<Target> {
        let (first, mut rest) = path.split_first()?;
        if depth > 16 {
            return None; // names that stand for each other
        }
        let mut at = match first.as_str() {
            "crate" => 0,
            "self" => scope,
            "super" => self.scopes[scope].parent,
            number if number.starts_with('#') => number[1..].parse().ok()?,
            name => match self.look_up(scope, name, !rest.is_empty(), depth)? {
                Target::Scope(inner) => inner,
                item => return Some(item),
            },
        };
        while let Some((name, after)) = rest.split_first() {
            rest = after;
            at = match name.as_str() {
                "super" => self.scopes[at].parent,
                "self" => at,
                _ => match self.look_up(at, name, !rest.is_empty(), depth) {
                    Some(Target::Scope(inner)) => inner,
                    Some(item) => return Some(item),
                    // An item of another crate, or one that a macro made: it is had from the module that is named.
                    None => return Some(Target::Item(at)),
                },
            };
        }
        Some(Target::Scope(at))
    }

    /// A name within a scope. A module may have the name of a function: `before_more` says that a module is meant.
    fn look_up(&self, scope: usize, name: &str, before_more: bool, depth: usize) -> Option<Target> {
        let here = self.scopes[scope].names.get(name).into_iter().flatten();
        let found: Vec<Target> = here
            .filter_map(|meant| match meant {
                Name::Scope(inner) => Some(Target::Scope(*inner)),
                Name::Item => Some(Target::Item(scope)),
                Name::Alias(path) => self.follow(scope, path, depth + 1),
            })
            .collect();
        let is_scope = |target: &&Target| matches!(target, Target::Scope(_));
        if let Some(target) = found.iter().find(|target| is_scope(target) == before_more).or(found.first()) {
            return Some(*target);
        }
        self.scopes[scope].globs.iter().find_map(|path| match self.follow(scope, path, depth + 1)? {
            Target::Scope(inner) if inner != scope && depth < 16 => self.look_up(inner, name, before_more, depth + 1),
            _ => None,
        })
    }
}

impl Scope {
    fn new(module: &str, file: &str, parent: usize, folder: &str) -> Self {
        let (module, file, folder) = (module.to_owned(), file.to_owned(), folder.to_owned());
        Self { module, file, parent, folder, items: Vec::new(), names: HashMap::new(), globs: Vec::new() }
    }

    fn define(&mut self, name: String) {
        self.names.entry(name).or_default().push(Name::Item);
    }

    fn define_all(&mut self, names: Vec<String>) {
        names.into_iter().for_each(|name| self.define(name));
    }
}

/// Enters what `use` brings into a scope. Those in functions count for the whole scope.
struct LocalUses<'a> {
    scope: &'a mut Scope,
}

impl<'ast> Visit<'ast> for LocalUses<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_test(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        for leaf in leaves(item) {
            if leaf.name == "*" {
                self.scope.globs.push(leaf.path);
            } else {
                self.scope.names.entry(leaf.name).or_default().push(Name::Alias(leaf.path));
            }
        }
    }
}

/// The leaves of a `use` that start in this crate or might do so.
pub(crate) fn leaves(item: &ItemUse) -> Vec<Leaf> {
    let mut leaves = Vec::new();
    if item.leading_colon.is_none() {
        collect(&item.tree, &mut Vec::new(), &mut leaves);
    }
    leaves
}

fn collect(tree: &UseTree, prefix: &mut Vec<String>, leaves: &mut Vec<Leaf>) {
    let mut leaf = |last: &syn::Ident, name: String| {
        let mut path = prefix.clone();
        // `use a::{self}` brings `a` itself.
        let own = last == "self" && !path.is_empty();
        if !own {
            path.push(last.to_string());
        }
        let name = if name == "self" { path.last().cloned().unwrap_or_default() } else { name };
        leaves.push(Leaf { path, name, line: last.span().start().line });
    };
    match tree {
        UseTree::Name(name) => leaf(&name.ident, name.ident.to_string()),
        UseTree::Rename(rename) => leaf(&rename.ident, rename.rename.to_string()),
        UseTree::Glob(glob) => {
            let line = glob.star_token.spans[0].start().line;
            leaves.push(Leaf { path: prefix.clone(), name: "*".to_owned(), line });
        }
        UseTree::Path(path) => {
            prefix.push(path.ident.to_string());
            collect(&path.tree, prefix, leaves);
            prefix.pop();
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| collect(tree, prefix, leaves)),
    }
}

/// The names that an item defines; of a macro's call those that follow `struct`, `fn` and the like.
fn defined(item: &Item) -> Vec<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        Item::Macro(call) => return defined_in(call.mac.tokens.clone()),
        _ => return Vec::new(),
    };
    vec![ident.to_string()]
}

fn defined_in(tokens: TokenStream) -> Vec<String> {
    const KEYWORDS: [&str; 7] = ["const", "enum", "fn", "static", "struct", "trait", "type"];
    let mut names = Vec::new();
    let mut after_keyword = false;
    for token in tokens {
        match token {
            TokenTree::Ident(ident) if after_keyword => {
                names.push(ident.to_string());
                after_keyword = false;
            }
            TokenTree::Ident(ident) => after_keyword = KEYWORDS.iter().any(|keyword| ident == keyword),
            _ => after_keyword = false,
        }
    }
    names
}

/// Whether code is there in tests only.
pub(crate) fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::Path(path) => path.is_ident("test"),
        Meta::List(list) => list.path.is_ident("cfg") && asks_for_test(list.tokens.clone()),
        Meta::NameValue(_) => false,
    })
}

/// Whether a condition holds in tests only, or in those of the documentation; `not(…)` does not, `any(…)` might not.
fn asks_for_test(condition: TokenStream) -> bool {
    let tokens: Vec<TokenTree> = condition.into_iter().collect();
    tokens.iter().enumerate().any(|(i, token)| match token {
        TokenTree::Ident(ident) => ident == "test" || ident == "doctest",
        TokenTree::Group(group) => {
            let of_all = i > 0 && matches!(&tokens[i - 1], TokenTree::Ident(ident) if ident == "all");
            of_all && asks_for_test(group.stream())
        }
        _ => false,
    })
}

/// The attributes of an item.
pub(crate) fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn path_attribute(attribute: &Attribute) -> Option<String> {
    let Meta::NameValue(pair) = &attribute.meta else { return None };
    let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(path), .. }) = &pair.value else { return None };
    pair.path.is_ident("path").then(|| path.value())
}

fn parsed(files: &BTreeMap<String, String>, file: &str) -> Result<Vec<Item>, String> {
    let text = files.get(file).ok_or_else(|| format!("{file} is not there"))?;
    let parsed = syn::parse_file(text).map_err(|e| format!("{file}:{}: {e}", e.span().start().line))?;
    Ok(parsed.items)
}

fn joined(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
}

fn folder_of(file: &str) -> &str {
    file.rsplit_once('/').map_or("", |(folder, _)| folder)
}
