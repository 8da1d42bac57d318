"""Counts data members and functions of classes and structs in a C++ file: a plain reader, no compiler."""
import re

HEAD = re.compile(r"\b(?:class|struct)\s+([A-Za-z_]\w*)(?:\s+final)?\s*(?::(?!:)[^;{}()]*)?\{")
NO_MEMBER = re.compile(
    r"^(using|typedef|friend|static_assert|enum|class|struct|union|static\s+constexpr|constexpr)\b")
NESTED = re.compile(r"^(template\s*<[^{]*>\s*)?(class|struct|union|enum)\b")


def without_comments(text):
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    text = re.sub(r'"(\\.|[^"\\\n])*"', '""', text)
    text = re.sub(r"'(\\.|[^'\\\n])'", "''", text)
    text = re.sub(r"//[^\n]*", "", text)
    return re.sub(r"^[ \t]*#[^\n]*", "", text, flags=re.M)


def end_of(text, begin, opening="{", closing="}"):
    """Index behind the bracket that closes the one at `begin`."""
    depth = 0
    for index in range(begin, len(text)):
        depth += (text[index] == opening) - (text[index] == closing)
        if depth == 0:
            return index + 1
    return len(text)


def without_arguments(statement):
    """Template arguments go: std::function<void(int)> f is no function."""
    for _ in range(8):
        shorter = re.sub(r"<[^<>]*>", "", statement)
        if shorter == statement:
            return statement
        statement = shorter
    return statement


def declared(statement):
    """(data members, functions) of a declaration without its initialisers' braces."""
    statement = re.sub(r"^\s*((public|private|protected)\s*:\s*)+", "", statement).strip()
    statement = re.sub(r"\[\[[^\]]*\]\]|\balignas\s*\([^)]*\)|\bmutable\b", "", statement).strip()
    if not statement or NO_MEMBER.match(statement):
        return 0, 0
    plain = re.sub(r"\boperator\s*\S+?\s*\(", "operator(", without_arguments(statement))
    if "(" in plain.split("=")[0]:
        return 0, 1
    names = re.sub(r"\{\}|=[^,]*", "", plain)
    return 1 + names.count(","), 0


def sizes_of(body):
    """(data members, functions) of a class's body."""
    data = functions = 0
    statement, index = "", 0
    while index < len(body):
        letter = body[index]
        if letter == ";":
            more = declared(statement)
            data, functions, statement = data + more[0], functions + more[1], ""
        elif letter == "{":
            head = re.sub(r"^\s*((public|private|protected)\s*:\s*)+", "", statement).strip()
            plain = without_arguments(head)
            index = end_of(body, index)
            if NESTED.match(head):      # "struct { ... } name;" is a member
                statement = "nested " if re.match(r"\s*\w",
                                                  body[index:]) and not body[index:].lstrip().startswith(
                    ("public", "private", "protected")) else ""
                if not statement:
                    index = body.find(";", index) + 1 or len(body)
            elif "(" in plain.split("=")[0] and not NO_MEMBER.match(head):
                functions, statement = functions + 1, ""
            else:
                statement += "{}"
            continue
        elif letter == "(":
            behind = end_of(body, index, "(", ")")
            statement += "()"
            index = behind
            continue
        else:
            statement += letter
        index += 1
    return data, functions


def class_sizes(text):
    """Yields (name, line, data members, functions, lists its fields for visit_fields)."""
    plain = without_comments(text)
    for found in HEAD.finditer(plain):
        if re.search(r"\benum\s*$", plain[:found.start()]):
            continue
        begin = found.end() - 1
        body = plain[begin + 1:end_of(plain, begin) - 1]
        data, functions = sizes_of(body)
        yield found.group(1), plain[:found.start()].count("\n") + 1, data, functions, "visit_fields" in body
