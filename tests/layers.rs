//! The direction of imports in `src`: no circle between modules, and nothing outside `src/python` names Python.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Top-level modules, and the top-level modules that each of them imports.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// A source file: its top-level module, its path in `src`, and its code without comments, texts and tests.
struct File {
    module: String,
    path: String,
    code: String,
}

/// All files of `src` that are not tests.
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

/// The code of a file, without comments, texts in double quotes, and the unit tests at its end.
fn code(source: &str) -> String {
    let source = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let without_comments = source.lines().map(|line| line.split("//").next().unwrap_or_default());
    let without_texts = without_comments.map(|line| line.split('"').step_by(2).collect::<String>());
    without_texts.collect::<Vec<_>>().join("\n")
}

/// First names of all paths from the crate's root: `a` and `b` of `crate::a::x` and of `crate::{a::x, b}`.
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

fn first_name(code: &str) -> String {
    code.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect()
}

/// Imports of each module of the core. Fails on a name that is not a module: the core imports from the module that owns a name.
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

/// Modules that import each other, directly or through others; empty if there are none.
fn circle(mut imports: Imports) -> Vec<String> {
    // Remove modules that import nothing that is left, until only circles, and what imports them, are left.
    loop {
        let left: BTreeSet<String> = imports.keys().cloned().collect();
        imports.retain(|_, imported| !imported.is_disjoint(&left));
        if imports.len() == left.len() {
            return left.into_iter().collect();
        }
    }
}

fn has_word(code: &str, word: &str) -> bool {
    code.split(|letter: char| !letter.is_alphanumeric() && letter != '_').any(|found| found == word)
}

#[test]
fn modules_do_not_import_each_other_in_a_circle() {
    let imports = imports(&files());
    assert!(imports["grid"].contains("free_boxes") && imports["scanner"].contains("raycast"), "imports are found");
    assert_eq!(circle(imports), Vec::<String>::new(), "modules in a circle, or that import one");
}

#[test]
fn only_the_binding_names_python() {
    for file in files().iter().filter(|file| file.module != "python") {
        for word in ["python", "pyo3", "numpy"] {
            // The crate's root declares the module of the binding.
            let declaration = file.module == "lib" && word == "python";
            let code = if declaration { file.code.replace("mod python;", "") } else { file.code.clone() };
            assert!(!has_word(&code, word), "src/{}.rs names {word}", file.path);
        }
    }
}

#[test]
fn imports_and_circles_are_found() {
    let code = code(
        "use crate::{a::{x, y}, b};\n// crate::not_this\nuse crate::c::z; \"crate::nor_this\"\n#[cfg(test)]\nmod tests { use crate::d; }",
    );
    assert_eq!(root_names(&code), ["a", "b", "c"].map(String::from).into());
    let imports = |edges: &[(&str, &[&str])]| -> Imports {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        edges.iter().map(|(name, imported)| ((*name).to_owned(), names(imported))).collect()
    };
    assert!(circle(imports(&[("a", &["b", "c"]), ("b", &["c"]), ("c", &[])])).is_empty());
    assert_eq!(circle(imports(&[("a", &["b"]), ("b", &["c"]), ("c", &["b"]), ("d", &[])])), ["a", "b", "c"]);
}
