//! The syntax of expressions: from the text after `=` to a tree.
//!
//! From the weakest to the strongest: `a ? b : c`, `||`, `&&`, comparisons, `+ -`, `* / %`, signs and `!`, `^`, `list[index]`.

use super::quantity::Quantity;

/// A part of an expression, and its byte offset in the text.
#[derive(Debug)]
pub(super) struct Expression {
    pub(super) at: usize,
    pub(super) kind: ExpressionKind,
}

#[derive(Debug)]
pub(super) enum ExpressionKind {
    Constant(Quantity),
    Name(String),
    List(Vec<Expression>),
    Minus(Box<Expression>),
    Not(Box<Expression>),
    /// Operators of one strength, from left to right: each with its byte offset.
    Chain(Box<Expression>, Vec<(Operator, usize, Expression)>),
    /// A condition and its two results.
    Choice(Box<[Expression; 3]>),
    /// A list and an index.
    Item(Box<[Expression; 2]>),
    Call(String, Vec<Expression>),
}

/// An operator between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    Or,
    And,
    Equal,
    NotEqual,
    LessOrEqual,
    GreaterOrEqual,
    Less,
    Greater,
    Plus,
    Minus,
    Times,
    Over,
    Modulo,
    Power,
}

/// Operators from the weakest to the strongest; of two that begin alike the longer one comes first.
const LEVELS: [&[(&str, Operator)]; 5] = [
    &[("||", Operator::Or)],
    &[("&&", Operator::And)],
    &[
        ("==", Operator::Equal),
        ("!=", Operator::NotEqual),
        ("<=", Operator::LessOrEqual),
        (">=", Operator::GreaterOrEqual),
        ("<", Operator::Less),
        (">", Operator::Greater),
    ],
    &[("+", Operator::Plus), ("-", Operator::Minus)],
    &[("*", Operator::Times), ("/", Operator::Over), ("%", Operator::Modulo)],
];

/// The greatest depth of parentheses, signs, powers, choices and calls.
const DEEPEST: usize = 48;

/// The fault of an expression, and the byte offset where. Without a message it follows from an error that is told
/// elsewhere.
#[derive(Debug, Default)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) message: String,
    pub(super) hint: Option<String>,
}

impl Fault {
    pub(super) fn new(at: usize, message: impl Into<String>) -> Self {
        Self { at, message: message.into(), hint: None }
    }

    pub(super) fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}

/// Whether a word can be the name of a variable.
pub(super) fn is_name(word: &str) -> bool {
    let mut characters = word.chars();
    characters.next().is_some_and(begins_name) && characters.all(continues_name)
}

fn begins_name(character: char) -> bool {
    character.is_alphabetic() || character == '_'
}

fn continues_name(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Parses the text of an expression from a byte offset on.
pub(super) fn parse(text: &str, start: usize) -> Result<Expression, Fault> {
    let mut parser = Parser { text, at: start, depth: 0 };
    let expression = parser.choice()?;
    match parser.next() {
        None => Ok(expression),
        Some(_) => Err(parser.expected("an operator or the end of the expression")),
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// The next character after spaces, which is not consumed.
    fn next(&mut self) -> Option<char> {
        self.at = self.text.len() - self.rest().trim_start().len();
        self.rest().chars().next()
    }

    /// Consumes a token if it is the next one.
    fn takes(&mut self, token: &str) -> bool {
        self.next();
        let is_next = self.rest().starts_with(token);
        if is_next {
            self.at += token.len();
        }
        is_next
    }

    fn must(&mut self, token: &str) -> Result<(), Fault> {
        if self.takes(token) { Ok(()) } else { Err(self.expected(&format!("`{token}`"))) }
    }

    fn expected(&mut self, what: &str) -> Fault {
        let found = match self.next() {
            None => "the expression ends here".to_owned(),
            Some(character) => format!("`{character}` stands here"),
        };
        Fault::new(self.at, format!("{found}; expected {what}"))
    }

    /// One level deeper, within the limit.
    fn deeper(
        &mut self,
        parse: impl FnOnce(&mut Self) -> Result<Expression, Fault>,
    ) -> Result<Expression, Fault> {
        if self.depth == DEEPEST {
            return Err(Fault::new(
                self.at,
                format!("the expression is nested deeper than {DEEPEST} levels"),
            )
            .hint("make variables of its parts"));
        }
        self.depth += 1;
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    fn choice(&mut self) -> Result<Expression, Fault> {
        let condition = self.chain(0)?;
        if !self.takes("?") {
            return Ok(condition);
        }
        let one = self.deeper(Self::choice)?;
        self.must(":")?;
        let other = self.deeper(Self::choice)?;
        Ok(Expression { at: condition.at, kind: ExpressionKind::Choice(Box::new([condition, one, other])) })
    }

    /// Operators of a level, between parts of the next one.
    fn chain(&mut self, level: usize) -> Result<Expression, Fault> {
        let Some(&operators) = LEVELS.get(level) else { return self.signed() };
        let first = self.chain(level + 1)?;
        let mut others = Vec::new();
        loop {
            self.next();
            let at = self.at;
            let Some(&(_, operator)) = operators.iter().find(|(token, _)| self.takes(token)) else { break };
            others.push((operator, at, self.chain(level + 1)?));
        }
        if others.is_empty() {
            return Ok(first);
        }
        Ok(Expression { at: first.at, kind: ExpressionKind::Chain(Box::new(first), others) })
    }

    fn signed(&mut self) -> Result<Expression, Fault> {
        self.next();
        let at = self.at;
        if self.takes("-") {
            let value = self.deeper(Self::signed)?;
            return Ok(Expression { at, kind: ExpressionKind::Minus(Box::new(value)) });
        }
        if self.takes("!") {
            let value = self.deeper(Self::signed)?;
            return Ok(Expression { at, kind: ExpressionKind::Not(Box::new(value)) });
        }
        let base = self.indexed()?;
        self.next();
        let operator = self.at;
        if !self.takes("^") {
            return Ok(base);
        }
        let exponent = self.deeper(Self::signed)?;
        Ok(Expression {
            at,
            kind: ExpressionKind::Chain(Box::new(base), vec![(Operator::Power, operator, exponent)]),
        })
    }

    fn indexed(&mut self) -> Result<Expression, Fault> {
        let value = self.primary()?;
        if !self.takes("[") {
            return Ok(value);
        }
        let index = self.deeper(Self::choice)?;
        self.must("]")?;
        Ok(Expression { at: value.at, kind: ExpressionKind::Item(Box::new([value, index])) })
    }

    fn primary(&mut self) -> Result<Expression, Fault> {
        let next = self.next();
        let at = self.at;
        let kind = match next {
            Some('(') => {
                self.at += 1;
                let inner = self.deeper(Self::choice)?;
                self.must(")")?;
                return Ok(inner);
            }
            Some('[') => {
                self.at += 1;
                ExpressionKind::List(self.listed("]")?)
            }
            Some('\'') => {
                let (text, _) = self.rest()[1..].split_once('\'').ok_or_else(|| {
                    Fault::new(at, "the text that begins here does not end; expected a `'`")
                })?;
                let text = text.to_owned();
                self.at += text.len() + 2;
                ExpressionKind::Constant(Quantity::Text(text))
            }
            Some('0'..='9' | '.') => self.number()?,
            Some(character) if begins_name(character) => {
                let rest = self.rest();
                let end = rest.find(|character| !continues_name(character)).unwrap_or(rest.len());
                let name = rest[..end].to_owned();
                self.at += end;
                if self.takes("(") {
                    ExpressionKind::Call(name, self.listed(")")?)
                } else {
                    ExpressionKind::Name(name)
                }
            }
            _ => return Err(self.expected("a number, a name, a 'text', a list or a parenthesis")),
        };
        Ok(Expression { at, kind })
    }

    /// Values between commas, up to a token.
    fn listed(&mut self, end: &str) -> Result<Vec<Expression>, Fault> {
        let mut items = Vec::new();
        while !self.takes(end) {
            items.push(self.deeper(Self::choice)?);
            if !self.takes(",") && !self.rest().starts_with(end) {
                return Err(self.expected(&format!("`,` or `{end}`")));
            }
        }
        Ok(items)
    }

    fn number(&mut self) -> Result<ExpressionKind, Fault> {
        let rest = self.rest();
        let mut end = 0;
        for (index, character) in rest.char_indices() {
            let is_exponents_sign = matches!(character, '+' | '-') && rest[..index].ends_with(['e', 'E']);
            if !(character.is_ascii_digit() || matches!(character, '.' | 'e' | 'E') || is_exponents_sign) {
                break;
            }
            end = index + 1;
        }
        let digits = &rest[..end];
        let number = digits.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| Fault::new(self.at, format!("`{digits}` is no finite number")))?;
        self.at += end;
        Ok(ExpressionKind::Constant(Quantity::Number(number)))
    }
}
