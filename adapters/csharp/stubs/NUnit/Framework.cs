using System;

namespace UnityEngine.TestTools
{
    public static class LogAssert
    {
        public static bool ignoreFailingMessages { get; set; }
    }
}

namespace NUnit.Framework
{
    [AttributeUsage(AttributeTargets.Method)]
    public sealed class TestAttribute : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Method)]
    public sealed class SetUpAttribute : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Method)]
    public sealed class TearDownAttribute : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Method, AllowMultiple = true)]
    public sealed class TestCaseAttribute : Attribute
    {
        public TestCaseAttribute(params object[] arguments)
        {
            Arguments = arguments;
        }

        public object[] Arguments { get; private set; }
    }

    public sealed class AssertionException : Exception
    {
        public AssertionException(string message)
            : base(message)
        {
        }
    }

    public static class Assert
    {
        public static void AreEqual(object expected, object actual, string message = "")
        {
            if (!Equals(expected, actual))
            {
                throw new AssertionException("expected " + expected + ", not " + actual + "; " + message);
            }
        }

        public static void AreEqual(double expected, double actual, double delta, string message = "")
        {
            if (!(Math.Abs(expected - actual) <= delta))
            {
                throw new AssertionException("expected " + expected + ", not " + actual + "; " + message);
            }
        }

        public static void IsTrue(bool condition, string message = "")
        {
            AreEqual(true, condition, message);
        }

        public static void IsFalse(bool condition, string message = "")
        {
            AreEqual(false, condition, message);
        }

        public static void IsNull(object thing)
        {
            AreEqual(null, thing);
        }

        public static void IsNotNull(object thing)
        {
            IsTrue(thing != null);
        }
    }
}
