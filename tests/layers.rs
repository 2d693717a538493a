//! The direction of imports in `src`: no import cycle between modules, and no mention of Python outside `src/python`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Top-level modules, and the top-level modules that each of them imports.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// A source file: its top-level module, its path in `src`, and its code without comments, string literals and tests.
struct File {
    module: String,
    path: String,
    code: String,
}

/// Returns all files of `src` that are not tests.
fn files() -> Vec<File> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    for path in rust_files(&root) {
        let relative = path.strip_prefix(&root).expect("below src").with_extension("");
        let parts: Vec<&str> = relative.iter().map(|part| part.to_str().expect("a name in UTF-8")).collect();
        if !parts.contains(&"tests") {
            let code = code(&fs::read_to_string(&path).expect("a readable file"));
            files.push(File { module: parts[0].to_owned(), path: parts.join("/"), code });
        }
    }
    files
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a readable folder").map(|entry| entry.expect("an entry").path());
    let mut found = Vec::new();
    for path in entries {
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// Returns the code of a file without comments, string literals and the unit tests at its end.
fn code(source: &str) -> String {
    let source = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let without_comments = source.lines().map(|line| line.split("//").next().unwrap_or_default());
    let without_texts = without_comments.map(|line| line.split('"').step_by(2).collect::<String>());
    without_texts.collect::<Vec<_>>().join("\n")
}

/// Returns the first name of each path from the crate's root: `a` of `crate::a::x`, `a` and `b` of `crate::{a::x, b}`.
fn root_names(code: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for rest in code.split("crate::").skip(1) {
        let Some(list) = rest.strip_prefix('{') else {
            names.insert(first_name(rest));
            continue;
        };
        let mut depth = 0;
        let mut is_first = true;
        for (index, letter) in list.char_indices() {
            if is_first && !letter.is_whitespace() && letter != '}' {
                names.insert(first_name(&list[index..]));
                is_first = false;
            }
            match letter {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => is_first = true,
                _ => {}
            }
        }
    }
    names
}

/// Returns the identifier at the start of a piece of code.
fn first_name(code: &str) -> String {
    code.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}

/// Returns the imports of each module of the core.
///
/// Fails on a name that is not a module: the core must import a name from the module that defines it, not from the crate's
/// root.
fn imports(files: &[File]) -> Imports {
    let core = || files.iter().filter(|file| file.module != "python" && file.module != "lib");
    let mut imports: Imports = core().map(|file| (file.module.clone(), BTreeSet::new())).collect();
    for file in core() {
        for name in root_names(&file.code) {
            assert!(imports.contains_key(&name), "src/{}.rs: crate::{name} is not a module of the core", file.path);
            if name != file.module {
                imports.get_mut(&file.module).expect("a module").insert(name);
            }
        }
    }
    imports
}

/// Returns the modules that are in an import cycle or import from one; empty if there is no cycle.
fn cycle(mut imports: Imports) -> Vec<String> {
    // Repeatedly remove the modules that import none of the remaining ones.
    loop {
        let remaining: BTreeSet<String> = imports.keys().cloned().collect();
        imports.retain(|_, imported| !imported.is_disjoint(&remaining));
        if imports.len() == remaining.len() {
            return remaining.into_iter().collect();
        }
    }
}

fn has_word(code: &str, word: &str) -> bool {
    code.split(|letter: char| !letter.is_alphanumeric() && letter != '_').any(|found| found == word)
}

#[test]
fn there_is_no_import_cycle() {
    let imports = imports(&files());
    assert!(imports["grid"].contains("free_boxes") && imports["scanner"].contains("raycast"), "imports are found");
    assert_eq!(cycle(imports), Vec::<String>::new(), "modules in an import cycle, or that import from one");
}

#[test]
fn only_the_binding_mentions_python() {
    for file in files().iter().filter(|file| file.module != "python") {
        for word in ["python", "pyo3", "numpy"] {
            // The crate's root must declare the module of the binding.
            let declaration = file.module == "lib" && word == "python";
            let code = if declaration { file.code.replace("mod python;", "") } else { file.code.clone() };
            assert!(!has_word(&code, word), "src/{}.rs mentions {word}", file.path);
        }
    }
}

#[test]
fn the_helpers_find_imports_and_cycles() {
    let code = code(
        "use crate::{a::{x, y}, b};\n// crate::not_this\nuse crate::c::z; \"crate::nor_this\"\n\
         #[cfg(test)]\nmod tests { use crate::d; }",
    );
    assert_eq!(root_names(&code), ["a", "b", "c"].map(String::from).into());
    let imports = |edges: &[(&str, &[&str])]| -> Imports {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        edges.iter().map(|(name, imported)| ((*name).to_owned(), names(imported))).collect()
    };
    assert!(cycle(imports(&[("a", &["b", "c"]), ("b", &["c"]), ("c", &[])])).is_empty());
    assert_eq!(cycle(imports(&[("a", &["b"]), ("b", &["c"]), ("c", &["b"]), ("d", &[])])), ["a", "b", "c"]);
}
