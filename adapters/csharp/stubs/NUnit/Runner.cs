using System;
using System.Reflection;

namespace NUnit.Framework
{
    /// <summary>Runs all tests of the given assemblies, those after `--play` in play mode. Not in NUnit.</summary>
    public static class Runner
    {
        private const BindingFlags All = BindingFlags.Instance | BindingFlags.Public | BindingFlags.DeclaredOnly;

        public static int Main(string[] assemblies)
        {
            int passed = 0, failed = 0;
            foreach (string path in assemblies)
            {
                if (path == "--play")
                {
                    UnityEngine.Engine.Play();
                    continue;
                }
                foreach (Type type in Assembly.LoadFrom(path).GetTypes())
                {
                    // one for all tests of a class
                    Lazy<object> fixture = new Lazy<object>(() => Activator.CreateInstance(type));
                    foreach (MethodInfo method in type.GetMethods(All))
                    {
                        Run(fixture, method, ref passed, ref failed);
                    }
                }
            }
            Console.WriteLine(passed + " passed, " + failed + " failed");
            return failed == 0 && passed > 0 ? 0 : 1;
        }

        private static void Run(Lazy<object> fixture, MethodInfo method, ref int passed, ref int failed)
        {
            if (method.IsDefined(typeof(TestAttribute), false))
            {
                Count(One(fixture.Value, method, null), ref passed, ref failed);
            }
            foreach (TestCaseAttribute given in method.GetCustomAttributes(typeof(TestCaseAttribute), false))
            {
                Count(One(fixture.Value, method, given.Arguments), ref passed, ref failed);
            }
        }

        private static void Count(bool good, ref int passed, ref int failed)
        {
            passed += good ? 1 : 0;
            failed += good ? 0 : 1;
        }

        private static bool One(object fixture, MethodInfo method, object[] arguments)
        {
            try
            {
                Prepare(fixture, typeof(SetUpAttribute));
                method.Invoke(fixture, arguments);
                return true;
            }
            catch (TargetInvocationException error)
            {
                Console.WriteLine(fixture.GetType().Name + "." + method.Name + ": " + error.InnerException);
                return false;
            }
            finally
            {
                Prepare(fixture, typeof(TearDownAttribute));
            }
        }

        private static void Prepare(object fixture, Type attribute)
        {
            foreach (MethodInfo method in fixture.GetType().GetMethods(All))
            {
                if (method.IsDefined(attribute, false))
                {
                    method.Invoke(fixture, null);
                }
            }
        }
    }
}
