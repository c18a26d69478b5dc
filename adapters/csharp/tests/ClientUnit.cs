using System;
using System.Collections.Generic;
using System.Reflection;

namespace Pacinian.Tests
{
    /// <summary>Runs all public methods of the test classes, and prints how many passed.</summary>
    internal static class ClientUnit
    {
        private static int Main()
        {
            int count = 0, failed = 0;
            foreach (Type type in new[]
            {
                typeof(ClientUnitOutbox), typeof(ClientUnitCommands), typeof(ClientUnitSessions), typeof(ClientUnitParts),
                typeof(ClientUnitZmtp), typeof(ClientUnitClient),
            })
            {
                foreach (MethodInfo method in type.GetMethods(
                    BindingFlags.Public | BindingFlags.Instance | BindingFlags.DeclaredOnly))
                {
                    count++;
                    try
                    {
                        method.Invoke(Activator.CreateInstance(type), null);
                    }
                    catch (TargetInvocationException error)
                    {
                        failed++;
                        Console.Out.WriteLine(type.Name + "." + method.Name + ": " + error.InnerException);
                    }
                }
            }
            Console.Out.WriteLine(failed == 0 ? count + " passed" : failed + " of " + count + " failed");
            return failed == 0 ? 0 : 1;
        }

        public static void Equal<T>(T wanted, T found)
        {
            if (!EqualityComparer<T>.Default.Equals(wanted, found))
            {
                throw new Exception("wanted " + wanted + ", found " + found);
            }
        }

        public static void Near(double wanted, double found, double within = 1e-9)
        {
            if (!(Math.Abs(wanted - found) <= within))
            {
                throw new Exception("wanted " + wanted + ", found " + found);
            }
        }

        public static void Raises<T>(Action what)
            where T : Exception
        {
            try
            {
                what();
            }
            catch (T)
            {
                return;
            }
            throw new Exception("wanted " + typeof(T));
        }

        public static void Holds(bool what)
        {
            Equal(true, what);
        }
    }
}
